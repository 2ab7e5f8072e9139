#include "images/writers/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "core/errors.h"
#include "core/files.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// Bytes of a one-page file; `path` determines its format and appears in an InputError. The file is
// built in memory, because OpenImageIO may fail to write to a disk without reporting it.
std::string bytes_of(const fs::path& path, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type,
                     const void* samples) {
  const std::string name = path.string();
  OIIO::Filesystem::IOVecOutput bytes;  // must outlive `output`, whose destructor writes the rest
  const auto output = OIIO::ImageOutput::create(name);
  const auto check = [&](bool succeeded) {
    if (succeeded) return;
    throw InputError({name}, "", output ? output->geterror() : OIIO::geterror(),
                     "a picture that this format can hold");
  };
  check(output != nullptr);
  output->threads(1);
  check(output->set_ioproxy(&bytes));
  check(output->open(name, spec));
  check(output->write_image(type, samples));
  check(output->close());
  return {bytes.buffer().begin(), bytes.buffer().end()};
}

OIIO::ImageSpec spec_of(int width, int height, const std::vector<std::string>& channels,
                        const OIIO::TypeDesc& type, const ImageMetadata& metadata) {
  OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), type);
  spec.channelnames = channels;
  spec.attribute("compression", "zip");
  spec.attribute("ImageDescription", metadata.description);
  spec.attribute("DocumentName", metadata.title);
  spec.attribute("Software", metadata.program);
  // Without this attribute OpenImageIO would write the time of day.
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

void write_png(const fs::path& path, const Picture& picture, const ImageMetadata& metadata) {
  const OIIO::ImageSpec spec =
      spec_of(picture.width, picture.height, {"R", "G", "B"}, OIIO::TypeDesc::UINT8, metadata);
  write_file_whole(path, bytes_of(path, spec, OIIO::TypeDesc::UINT8, picture.rgb.data()));
}

}  // namespace photorque
