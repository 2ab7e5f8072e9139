// Changes of TM-25 files, which are 36 kB of names and remarks between a short header and the rays:
// half of the changes fall on the header's numbers, most others on what follows the texts.
#include <array>
#include <cstring>

#include "tests/fuzz/random_bytes.h"

namespace {

constexpr size_t header_bytes = 288, body = header_bytes + 36000;
constexpr std::array<uint32_t, 10> words = {
    0, 1, 2, 3, 0x7fc00000, 0x7f800000, 0x3f800000, 0x7fffffff, 0xffffffff, 64};

}  // namespace

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned seed) {
  photorque::fuzz::Chance chance(seed);
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  if (size < body || chance.below(16) == 0) return LLVMFuzzerMutate(data, size, max_size);
  std::string head = bytes.substr(0, header_bytes), rest = bytes.substr(body);
  for (size_t left = 1 + chance.below(3); left > 0; --left) {
    if (chance.below(2) == 0) {
      const uint32_t word = chance.one_of(words);
      std::memcpy(head.data() + 4 * chance.below(head.size() / 4), &word, sizeof word);
    } else {
      rest = photorque::fuzz::with_bytes_changed(rest);
    }
  }
  return photorque::fuzz::put(head + bytes.substr(header_bytes, body - header_bytes) + rest, data,
                              max_size);
}
