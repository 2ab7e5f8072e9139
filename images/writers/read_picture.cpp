#include "images/writers/read_picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "core/errors.h"

namespace photorque {
namespace {

// IEC 61966-2-1.
float linear_from_srgb(float value) {
  return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

uint32_t word_of(std::string_view bytes) {
  uint32_t word = 0;
  for (const char byte : bytes.substr(0, 4)) word = word << 8 | static_cast<unsigned char>(byte);
  return word;
}

// PNG's checksum, table by table.
// Source: ISO/IEC 15948:2003, annex D.
uint32_t checksum_of(std::string_view bytes) {
  static const std::array<uint32_t, 256> table = [] {
    std::array<uint32_t, 256> all{};
    for (uint32_t n = 0; n < all.size(); ++n) {
      all[n] = n;
      for (int k = 0; k < 8; ++k)
        all[n] = (all[n] & 1) != 0 ? 0xedb88320u ^ all[n] >> 1 : all[n] >> 1;
    }
    return all;
  }();
  uint32_t sum = ~0u;
  for (const char byte : bytes)
    sum = table[(sum ^ static_cast<unsigned char>(byte)) & 0xff] ^ sum >> 8;
  return ~sum;
}

// Whether every chunk of a PNG is there and as it was written: of one that is not, its library says
// so on the terminal, beside the one line that this program promises.
bool has_whole_chunks(std::string_view png) {
  constexpr size_t signature = 8,
                   around = 12;  // of a chunk: length and type before, checksum after
  for (std::string_view rest = png.substr(std::min(signature, png.size()));
       rest.size() >= around;) {
    const size_t length = word_of(rest);
    if (length > rest.size() - around) return false;
    const std::string_view sealed = rest.substr(4, 4 + length);
    if (word_of(rest.substr(8 + length)) != checksum_of(sealed)) return false;
    if (sealed.starts_with("IEND")) return true;
    rest.remove_prefix(around + length);
  }
  return false;
}

}  // namespace

LinearPicture read_picture(const std::string& bytes) {
  const InputError wrong({"picture"}, "", "bytes that are no picture", "a PNG or JPEG");
  // Three floats each: 0.8 GB.
  constexpr int64_t max_texels = int64_t{1} << 26;
  const bool is_png = bytes.starts_with("\x89PNG");
  if (!is_png && !bytes.starts_with("\xFF\xD8")) throw wrong;
  if (is_png && !has_whole_chunks(bytes)) {
    throw InputError({"picture"}, "", "a PNG that is damaged or cut off", "a whole one");
  }
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
