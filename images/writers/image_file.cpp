#include "images/writers/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "core/errors.h"
#include "core/files.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// A file that is being written; every failure becomes an InputError that names the final path.
class ImageFile {
 public:
  ImageFile(fs::path final_path, const fs::path& temporary)
      : final_path_(std::move(final_path)),
        temporary_(temporary.string()),
        output_(OIIO::ImageOutput::create(temporary_)) {
    if (!output_) fail(OIIO::geterror());
    output_->threads(1);
  }

  void into(OIIO::Filesystem::IOProxy& bytes) { check(output_->set_ioproxy(&bytes)); }
  void open(const OIIO::ImageSpec& spec) { check(output_->open(temporary_, spec)); }
  void open_pages(const std::vector<OIIO::ImageSpec>& specs) {
    check(output_->open(temporary_, static_cast<int>(specs.size()), specs.data()));
  }
  void next_page(const OIIO::ImageSpec& spec) {
    check(output_->open(temporary_, spec, OIIO::ImageOutput::AppendSubimage));
  }
  void write(const OIIO::TypeDesc& type, const void* samples) {
    check(output_->write_image(type, samples));
  }
  void close() { check(output_->close()); }

 private:
  void check(bool succeeded) {
    if (!succeeded) fail(output_->geterror());
  }
  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError({final_path_.string()}, "", reason, "a path that can be written");
  }

  fs::path final_path_;
  std::string temporary_;
  std::unique_ptr<OIIO::ImageOutput> output_;
};

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
  write_file_whole(path, [&](const fs::path& temporary) {
    ImageFile file(path, temporary);
    file.open(spec);
    file.write(OIIO::TypeDesc::FLOAT, interleaved.data());
    file.close();
  });
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
  });
}

std::string png_bytes(const Picture& picture, const ImageMetadata& metadata) {
  OIIO::Filesystem::IOVecOutput bytes;
  const fs::path name = "memory.png";
  ImageFile file(name, name);
  file.into(bytes);
  file.open(
      spec_of(picture.width, picture.height, {"R", "G", "B"}, OIIO::TypeDesc::UINT8, metadata));
  file.write(OIIO::TypeDesc::UINT8, picture.rgb.data());
  file.close();
  return {bytes.buffer().begin(), bytes.buffer().end()};
}

// By our own writer: that of OpenImageIO does not tell of a write that failed.
void write_png(const fs::path& path, const Picture& picture, const ImageMetadata& metadata) {
  write_file_whole(path, png_bytes(picture, metadata));
}

}  // namespace photorque
