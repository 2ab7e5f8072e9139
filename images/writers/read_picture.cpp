#include "images/writers/read_picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cmath>

#include "core/errors.h"

namespace photorque {
namespace {

// IEC 61966-2-1.
float linear_from_srgb(float value) {
  return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

}  // namespace

LinearPicture read_picture(const std::string& bytes) {
  const InputError wrong({"picture"}, "", "bytes that are no picture", "a PNG or JPEG");
  constexpr int64_t max_texels = int64_t{1} << 28;
  const bool is_png = bytes.starts_with("\x89PNG");
  if (!is_png && !bytes.starts_with("\xFF\xD8")) throw wrong;
  OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
  const auto input =
      OIIO::ImageInput::open(is_png ? "picture.png" : "picture.jpg", nullptr, &memory);
  if (!input) {
    OIIO::geterror();  // not to be found by whoever asks next
    throw wrong;
  }
  const OIIO::ImageSpec& spec = input->spec();
  const int channels = spec.nchannels;
  if (spec.width < 1 || spec.height < 1 || channels < 1 ||
      int64_t{spec.width} * spec.height > max_texels) {
    throw wrong;
  }
  const size_t texels = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
  std::vector<float> values(texels * static_cast<size_t>(channels));
  if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, values.data())) throw wrong;
  LinearPicture picture{spec.width, spec.height, std::vector<float>(3 * texels)};
  for (size_t i = 0; i < texels; ++i) {
    for (size_t k = 0; k < 3; ++k) {
      const size_t channel = channels >= 3 ? k : 0;
      picture.rgb[3 * i + k] =
          linear_from_srgb(values[i * static_cast<size_t>(channels) + channel]);
    }
  }
  return picture;
}

}  // namespace photorque
