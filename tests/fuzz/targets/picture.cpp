// Fuzz target: any bytes as the picture of a model. picture_mutator.cpp changes chunks of PNGs.
#include "images/writers/image_file.h"

#include <cstdint>

#include "tests/fuzz/target.h"

namespace {

uint64_t big_endian(const std::string& bytes, size_t at, size_t count) {
  uint64_t value = 0;
  for (size_t i = 0; i < count && at + i < bytes.size(); ++i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  }
  return value;
}

// By the header: of a PNG its first chunk, of a JPEG what looks like the largest of its frames.
uint64_t declared_texels(const std::string& bytes) {
  if (bytes.starts_with("\x89PNG")) return big_endian(bytes, 16, 4) * big_endian(bytes, 20, 4);
  uint64_t most = 0;
  for (size_t i = 0; i + 9 < bytes.size(); ++i) {
    const bool frame = bytes[i] == '\xff' && (bytes[i + 1] & 0xf0) == 0xc0;
    if (frame) most = std::max(most, big_endian(bytes, i + 5, 2) * big_endian(bytes, i + 7, 2));
  }
  return most;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const std::string bytes = fuzz::text_of(data, size);
  // Larger ones take their time, which is no fault; what its bytes cannot hold is refused at once.
  constexpr uint64_t slow = 1 << 14, texels_per_byte = 8 * 1032;
  const uint64_t texels = declared_texels(bytes);
  if (texels > slow && texels <= size * texels_per_byte) return 0;
  fuzz::may_refuse([&] {
    const LinearPicture picture = read_picture(bytes);
    for (const float value : picture.rgb) {
      if (!(value >= 0.0F && value <= 1.0F)) std::abort();
    }
  });
  return 0;
}
