#include "images/writers/read_picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
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
  // Three floats each: 0.8 GB.
  constexpr int64_t max_texels = int64_t{1} << 26;
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
  if (spec.width < 1 || spec.height < 1 || channels < 1) throw wrong;
  if (int64_t{spec.width} * spec.height > max_texels) {
    throw InputError({"picture"}, "",
                     std::to_string(spec.width) + " x " + std::to_string(spec.height) + " texels",
                     "at most " + std::to_string(max_texels) + " of them");
  }
  const auto width = static_cast<size_t>(spec.width);
  LinearPicture picture{spec.width, spec.height, {}};
  // As rows come, so that no header makes this allocate what the file does not bear out.
  constexpr int rows_at_once = 64;
  std::vector<float> values(width * rows_at_once * static_cast<size_t>(channels));
  for (int row = 0; row < spec.height; row += rows_at_once) {
    const int end = std::min(row + rows_at_once, spec.height);
    if (!input->read_scanlines(0, 0, row, end, 0, 0, channels, OIIO::TypeDesc::FLOAT,
                               values.data())) {
      throw wrong;
    }
    for (size_t i = 0; i < width * static_cast<size_t>(end - row); ++i) {
      for (size_t k = 0; k < 3; ++k) {
        const size_t channel = channels >= 3 ? k : 0;
        picture.rgb.push_back(
            linear_from_srgb(values[i * static_cast<size_t>(channels) + channel]));
      }
    }
  }
  return picture;
}

}  // namespace photorque
