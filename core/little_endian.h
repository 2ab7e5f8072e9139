// Numbers in binary files, little-endian on any machine.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/errors.h"

namespace photorque {

// The number in the four bytes that start at `at`, which must exist.
inline uint32_t little_endian_32(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// Reads numbers in sequence. Throws InputError at the end of the bytes.
class LittleEndianReader {
 public:
  LittleEndianReader(std::string_view bytes, std::string file)
      : bytes_(bytes), file_(std::move(file)) {}

  uint64_t left() const { return bytes_.size() - at_; }
  InputLocation where() const { return {file_}; }

  std::string_view take(uint64_t count, const char* what) {
    if (count > left()) {
      throw InputError(where(), what,
                       "the end of the file at byte " + std::to_string(bytes_.size()),
                       std::to_string(count - left()) + " more bytes");
    }
    const std::string_view taken = bytes_.substr(at_, count);
    at_ += count;
    return taken;
  }
  void skip(uint64_t count, const char* what) { take(count, what); }

  template <std::unsigned_integral Integer>
  Integer unsigned_integer(const char* what) {
    Integer value = 0;
    int shift = 0;
    for (const char c : take(sizeof(Integer), what)) {
      value |= static_cast<Integer>(static_cast<Integer>(static_cast<unsigned char>(c)) << shift);
      shift += 8;
    }
    return value;
  }
  int32_t int32(const char* what) { return static_cast<int32_t>(unsigned_integer<uint32_t>(what)); }
  float float32(const char* what) { return std::bit_cast<float>(unsigned_integer<uint32_t>(what)); }

 private:
  std::string_view bytes_;
  std::string file_;
  uint64_t at_ = 0;
};

// Appends numbers to bytes.
class LittleEndianWriter {
 public:
  template <std::unsigned_integral Integer>
  void unsigned_integer(Integer value) {
    for (size_t i = 0; i < sizeof(Integer); ++i) {
      bytes_ += static_cast<char>(static_cast<unsigned char>(value >> (8 * i) & 0xFF));
    }
  }
  void int32(int32_t value) { unsigned_integer(static_cast<uint32_t>(value)); }
  void float32(double value) {
    unsigned_integer(std::bit_cast<uint32_t>(static_cast<float>(value)));
  }
  void text(std::string_view text, size_t length) {
    bytes_ += text.substr(0, length);
    zeros(length - std::min(length, text.size()));
  }
  void zeros(size_t count) { bytes_.append(count, '\0'); }
  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace photorque
