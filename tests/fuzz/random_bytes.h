// Shared by mutators: chance, and the fuzzer's own changes of bytes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>

// Defined by libFuzzer or, without it, by mutate.cpp.
extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

namespace photorque::fuzz {

class Chance {
 public:
  explicit Chance(unsigned seed) : random_(seed) {}

  size_t below(size_t n) { return n == 0 ? 0 : static_cast<size_t>(random_() % n); }
  template <typename List>
  const auto& one_of(const List& list) {
    return list[below(std::size(list))];
  }

 private:
  std::mt19937_64 random_;
};

// `text` with a few of its bytes changed, at most `room` longer.
inline std::string with_bytes_changed(std::string text, size_t room = 64) {
  const size_t size = text.size();
  text.resize(size + room);
  text.resize(LLVMFuzzerMutate(reinterpret_cast<uint8_t*>(text.data()), size, text.size()));
  return text;
}

// Where a mutator leaves its work; returns its size.
inline size_t put(const std::string& text, uint8_t* data, size_t max_size) {
  const size_t size = std::min(text.size(), max_size);
  std::copy_n(text.begin(), size, reinterpret_cast<char*>(data));
  return size;
}

}  // namespace photorque::fuzz
