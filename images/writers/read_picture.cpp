#include "images/writers/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/errors.h"

namespace photorque {
namespace {

// Source: IEC 61966-2-1.
float linear_from_srgb(float value) {
  return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

uint32_t word_of(std::string_view bytes) {
  uint32_t word = 0;
  for (const char byte : bytes.substr(0, 4)) word = word << 8 | static_cast<unsigned char>(byte);
  return word;
}

// Whether every chunk of a PNG is complete with a correct checksum. Otherwise libpng would print
// messages on the terminal.
bool has_whole_chunks(std::string_view png) {
  constexpr size_t signature = 8,
                   around = 12;  // of a chunk: length and type before, checksum after
  for (std::string_view rest = png.substr(std::min(signature, png.size()));
       rest.size() >= around;) {
    const size_t length = word_of(rest);
    if (length > rest.size() - around) return false;
    const std::string_view sealed = rest.substr(4, 4 + length);
    const auto* const bytes = reinterpret_cast<const Bytef*>(sealed.data());
    if (word_of(rest.substr(8 + length)) != crc32_z(0, bytes, sealed.size())) return false;
    if (sealed.starts_with("IEND")) return true;
    rest.remove_prefix(around + length);
  }
  return false;
}

// Width and height by the header, because libraries allocate memory for a whole progressive JPEG
// when they open it. Empty without a header. Source: ITU-T T.81, annex B; ISO/IEC 15948:2003,
// clause 11.2.2.
std::optional<std::array<int64_t, 2>> stated_size(std::string_view bytes) {
  constexpr size_t png_width = 16, png_end = 24, frame_bytes = 9;
  if (bytes.starts_with("\x89PNG")) {
    if (bytes.size() < png_end) return std::nullopt;
    return {{word_of(bytes.substr(png_width)), word_of(bytes.substr(png_width + 4))}};
  }
  for (size_t at = 2; at + frame_bytes <= bytes.size();) {
    const auto marker = static_cast<unsigned char>(bytes[at + 1]);
    if (bytes[at] != '\xff' || marker == 0x00 || marker == 0xff) {
      ++at;  // bytes between segments are skipped
      continue;
    }
    const bool is_frame =
        (marker & 0xf0) == 0xc0 && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (is_frame) {
      const uint32_t height_and_width = word_of(bytes.substr(at + 5));
      return {{height_and_width & 0xffff, height_and_width >> 16}};
    }
    const bool stands_alone = marker == 0x01 || (marker & 0xf8) == 0xd0;
    at += 2 + (stands_alone ? 0 : word_of(bytes.substr(at + 2)) >> 16);
  }
  return std::nullopt;
}

// Throws InputError for a picture that is too large or truncated. A byte of deflated data yields at
// most 1032 bytes of eight texels each, a byte of JPEG fewer. A decoder would invent the missing
// texels.
void require_affordable(const std::array<int64_t, 2>& size, size_t bytes) {
  // Three floats per texel: 0.8 GB.
  constexpr int64_t max_texels = int64_t{1} << 26, texels_per_byte = int64_t{8} * 1032;
  // Each side has 32 bits, so that the product can need 64 bits.
  const auto [width, height] = size;
  if (width > max_texels || height > max_texels || width * height > max_texels) {
    throw InputError({"picture"}, "",
                     std::to_string(width) + " x " + std::to_string(height) + " texels",
                     "at most " + std::to_string(max_texels) + " of them");
  }
  const int64_t most = static_cast<int64_t>(bytes) * texels_per_byte;
  if (width * height > most) {
    throw InputError(
        {"picture"}, "",
        std::to_string(width * height) + " texels in " + std::to_string(bytes) + " bytes",
        "a whole picture, of " + std::to_string(most) + " texels at most");
  }
}

}  // namespace

LinearPicture read_picture(const std::string& bytes) {
  const InputError wrong({"picture"}, "", "bytes that are no picture", "a PNG or JPEG");
  const bool is_png = bytes.starts_with("\x89PNG");
  if (!is_png && !bytes.starts_with("\xFF\xD8")) throw wrong;
  if (is_png && !has_whole_chunks(bytes)) {
    throw InputError({"picture"}, "", "a PNG that is damaged or cut off", "a whole one");
  }
  if (const auto size = stated_size(bytes)) require_affordable(*size, bytes.size());
  OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
  // Keep colours as stored: OpenImageIO would multiply them by alpha, which glTF does not require.
  OIIO::ImageSpec wanted;
  wanted.attribute("oiio:UnassociatedAlpha", 1);
  void* const from = &memory;
  wanted.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, static_cast<const void*>(&from));
  const auto input =
      OIIO::ImageInput::open(is_png ? "picture.png" : "picture.jpg", &wanted, &memory);
  if (!input) {
    OIIO::geterror();  // cleared for the next caller
    throw wrong;
  }
  const OIIO::ImageSpec& spec = input->spec();
  const int channels = spec.nchannels;
  if (spec.width < 1 || spec.height < 1 || channels < 1) throw wrong;
  require_affordable({spec.width, spec.height}, bytes.size());
  const auto width = static_cast<size_t>(spec.width);
  LinearPicture picture{spec.width, spec.height, {}};
  picture.rgb.reserve(3 * width * static_cast<size_t>(spec.height));
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
