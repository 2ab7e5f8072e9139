#include "images/writers/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstring>

#include "core/errors.h"
#include "core/files.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// A file that is being written at `place`; every failure becomes an InputError that names the final
// path.
class ImageFile {
 public:
  ImageFile(fs::path final_path, const fs::path& place)
      : final_path_(std::move(final_path)),
        place_(place.string()),
        output_(OIIO::ImageOutput::create(place_)) {
    if (!output_) fail(OIIO::geterror());
    output_->threads(1);
  }

  void into(OIIO::Filesystem::IOProxy& bytes) { check(output_->set_ioproxy(&bytes)); }
  void open(const OIIO::ImageSpec& spec) { check(output_->open(place_, spec)); }
  void open_pages(const std::vector<OIIO::ImageSpec>& specs) {
    check(output_->open(place_, static_cast<int>(specs.size()), specs.data()));
  }
  void next_page(const OIIO::ImageSpec& spec) {
    check(output_->open(place_, spec, OIIO::ImageOutput::AppendSubimage));
  }
  void write(const OIIO::TypeDesc& type, const void* samples) {
    check(output_->write_image(type, samples));
  }
  void close() { check(output_->close()); }
  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError({final_path_.string()}, "", reason, "a path that can be written");
  }

 private:
  void check(bool succeeded) {
    if (!succeeded) fail(output_->geterror());
  }

  fs::path final_path_;
  std::string place_;
  std::unique_ptr<OIIO::ImageOutput> output_;
};

// A file of one page, made in memory: what OpenImageIO writes to a disk itself may fail without a
// word.
std::string bytes_of(const fs::path& path, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type,
                     const void* samples) {
  OIIO::Filesystem::IOVecOutput bytes;
  ImageFile file(path, path);
  file.into(bytes);
  file.open(spec);
  file.write(type, samples);
  file.close();
  return {bytes.buffer().begin(), bytes.buffer().end()};
}

// Whether a file has these pages, name by name and sample by sample.
bool holds(const fs::path& path, const std::vector<OIIO::ImageSpec>& specs,
           const std::vector<ImageChannel>& channels) {
  const auto file = OIIO::ImageInput::open(path.string());
  if (!file) return false;
  for (size_t page = 0; page < channels.size(); ++page) {
    const int number = static_cast<int>(page);
    if (!file->seek_subimage(number, 0)) return false;
    for (const char* text : {"ImageDescription", "DocumentName", "Software"}) {
      if (file->spec().get_string_attribute(text) != specs[page].get_string_attribute(text)) {
        return false;
      }
    }
    std::vector<float> samples(channels[page].samples.size());
    if (file->spec().image_pixels() != samples.size() ||
        !file->read_image(number, 0, 0, 1, OIIO::TypeDesc::FLOAT, samples.data()) ||
        std::memcmp(samples.data(), channels[page].samples.data(),
                    samples.size() * sizeof(float)) != 0) {
      return false;
    }
  }
  return true;
}

OIIO::ImageSpec spec_of(int width, int height, const std::vector<std::string>& channels,
                        const OIIO::TypeDesc& type, const ImageMetadata& metadata) {
  OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), type);
  spec.channelnames = channels;
  spec.attribute("compression", "zip");
  spec.attribute("ImageDescription", metadata.description);
  spec.attribute("DocumentName", metadata.title);
  spec.attribute("Software", metadata.program);
  // Left out, OpenImageIO would write the time of day.
  spec.attribute("DateTime", "");
  return spec;
}

}  // namespace

void write_exr(const fs::path& path, int width, int height,
               const std::vector<ImageChannel>& channels, const ImageMetadata& metadata) {
  std::vector<std::string> names;
  for (const ImageChannel& channel : channels) names.push_back(channel.name);
  OIIO::ImageSpec spec = spec_of(width, height, names, OIIO::TypeDesc::FLOAT, metadata);
  for (const auto& [name, text] : metadata.texts) spec.attribute(name, text);
  for (const auto& [name, number] : metadata.numbers) {
    spec.attribute(name, OIIO::TypeDesc::DOUBLE, &number);
  }
  const size_t pixels = static_cast<size_t>(width) * height;
  std::vector<float> interleaved;
  interleaved.reserve(pixels * channels.size());
  for (size_t i = 0; i < pixels; ++i) {
    for (const ImageChannel& channel : channels) interleaved.push_back(channel.samples[i]);
  }
  write_file_whole(path, bytes_of(path, spec, OIIO::TypeDesc::FLOAT, interleaved.data()));
}

void write_tiff(const fs::path& path, int width, int height,
                const std::vector<ImageChannel>& channels, const ImageMetadata& metadata) {
  std::vector<OIIO::ImageSpec> specs;
  for (const ImageChannel& channel : channels) {
    specs.push_back(spec_of(width, height, {"Y"}, OIIO::TypeDesc::FLOAT, metadata));
    // OpenImageIO 2.4 writes no PageName.
    specs.back().attribute("DocumentName", channel.name);
  }
  write_file_whole(path, [&](const fs::path& temporary) {
    ImageFile file(path, temporary);
    file.open_pages(specs);
    for (size_t page = 0; page < channels.size(); ++page) {
      if (page > 0) file.next_page(specs[page]);
      file.write(OIIO::TypeDesc::FLOAT, channels[page].samples.data());
    }
    file.close();
    // Several pages cannot be made in memory (OpenImageIO 2.4 links the last one only), so that
    // what failed without a word is found by reading.
    if (!holds(temporary, specs, channels)) file.fail("a write that failed");
  });
}

std::string png_bytes(const Picture& picture, const ImageMetadata& metadata) {
  return bytes_of(
      "memory.png",
      spec_of(picture.width, picture.height, {"R", "G", "B"}, OIIO::TypeDesc::UINT8, metadata),
      OIIO::TypeDesc::UINT8, picture.rgb.data());
}

void write_png(const fs::path& path, const Picture& picture, const ImageMetadata& metadata) {
  write_file_whole(path, png_bytes(picture, metadata));
}

}  // namespace photorque
