// Changes of PNGs: what stands in a chunk is changed, chunks are left out, doubled and exchanged,
// and each is sealed with its checksum again, so that what is wrong is found behind that.
// Source: ISO/IEC 15948:2003, clause 5.
#include <zlib.h>

#include <cstdint>
#include <vector>

#include "tests/fuzz/random_bytes.h"

namespace {

using photorque::fuzz::Chance;

constexpr size_t signature = 8, around = 12, type_bytes = 4;  // around: length, type and checksum

uint32_t word_at(const std::string& bytes, size_t at) {
  uint32_t word = 0;
  for (size_t i = 0; i < 4; ++i) word = word << 8 | static_cast<unsigned char>(bytes[at + i]);
  return word;
}

void add_word(std::string& bytes, size_t word) {
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(word >> shift & 0xff);
}

// Type and content of each chunk.
std::vector<std::string> chunks_of(const std::string& png) {
  std::vector<std::string> chunks;
  for (size_t at = signature; at + around <= png.size();) {
    const size_t length = std::min<size_t>(word_at(png, at), png.size() - at - around);
    chunks.push_back(png.substr(at + 4, type_bytes + length));
    at += around + length;
  }
  return chunks;
}

std::string joined(const std::string& head, const std::vector<std::string>& chunks) {
  std::string png = head;
  for (const std::string& chunk : chunks) {
    add_word(png, chunk.size() - type_bytes);
    png += chunk;
    add_word(png, crc32(0, reinterpret_cast<const Bytef*>(chunk.data()),
                        static_cast<uInt>(chunk.size())));
  }
  return png;
}

// The rows of a picture, changed before they are compressed.
std::string with_rows_changed(const std::string& content) {
  std::string rows(1 << 16, '\0');
  uLongf size = rows.size();
  if (uncompress(reinterpret_cast<Bytef*>(rows.data()), &size,
                 reinterpret_cast<const Bytef*>(content.data()), content.size()) != Z_OK) {
    return photorque::fuzz::with_bytes_changed(content);
  }
  rows.resize(size);
  rows = photorque::fuzz::with_bytes_changed(rows);
  std::string packed(compressBound(rows.size()), '\0');
  uLongf packed_size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &packed_size,
           reinterpret_cast<const Bytef*>(rows.data()), rows.size());
  packed.resize(packed_size);
  return packed;
}

void change(std::vector<std::string>& chunks, Chance& chance) {
  const size_t at = chance.below(chunks.size());
  const auto place = chunks.begin() + static_cast<std::ptrdiff_t>(at);
  std::string& chunk = chunks[at];
  const std::string content = chunk.substr(type_bytes);
  switch (chance.below(8)) {
    case 0:
      if (chunks.size() > 1) chunks.erase(place);
      break;
    case 1:
      chunks.insert(place, std::string(chance.one_of(chunks)));
      break;
    case 2:
      std::swap(chunk, chunks[chance.below(chunks.size())]);
      break;
    case 3:
    case 4:
      if (chunk.starts_with("IDAT")) {
        chunk = "IDAT" + with_rows_changed(content);
        break;
      }
      [[fallthrough]];
    default:
      chunk = chunk.substr(0, type_bytes) + photorque::fuzz::with_bytes_changed(content);
  }
}

}  // namespace

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned seed) {
  Chance chance(seed);
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  std::vector<std::string> chunks;
  if (bytes.starts_with("\x89PNG")) chunks = chunks_of(bytes);
  if (chunks.empty() || chance.below(16) == 0) return LLVMFuzzerMutate(data, size, max_size);
  for (size_t left = 1 + chance.below(3); left > 0; --left) change(chunks, chance);
  return photorque::fuzz::put(joined(bytes.substr(0, signature), chunks), data, max_size);
}
