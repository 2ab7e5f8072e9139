#include "scenes/gltf/file/container.h"

#include <cstdint>

#include "core/errors.h"

namespace photorque::gltf {
namespace {

// glTF 2.0, section 4.4.
constexpr uint32_t magic = 0x46546C67;       // "glTF"
constexpr uint32_t json_chunk = 0x4E4F534A;  // "JSON"
constexpr uint32_t bin_chunk = 0x004E4942;   // "BIN\0"
constexpr size_t header_bytes = 12;
constexpr size_t chunk_header_bytes = 8;

// Little-endian; the caller has checked that four bytes are there.
uint32_t word(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

std::string bytes_text(uint64_t count) {
  return std::to_string(count) + " bytes";
}

struct Chunk {
  uint32_t type = 0;
  std::string_view data;
};

// The bytes between the header and the declared end.
std::string_view checked_body(std::string_view bytes, const std::string& file,
                              std::vector<std::string>* notices) {
  const auto wrong = [&](const std::string& found, const std::string& expected) {
    return InputError({file}, "GLB header", found, expected);
  };
  if (bytes.size() < header_bytes) throw wrong(bytes_text(bytes.size()), "at least 12 bytes");
  if (word(bytes, 0) != magic) throw wrong("no magic word", "a file that begins with \"glTF\"");
  if (word(bytes, 4) != 2) throw wrong("version " + std::to_string(word(bytes, 4)), "version 2");
  const size_t length = word(bytes, 8);
  if (length < header_bytes + chunk_header_bytes || length > bytes.size()) {
    throw wrong("a length of " + bytes_text(length) + " in a file of " + bytes_text(bytes.size()),
                "the length of the file");
  }
  if (length < bytes.size()) {
    notices->push_back(bytes_text(bytes.size() - length) + " after the end of the GLB are ignored");
  }
  return bytes.substr(header_bytes, length - header_bytes);
}

std::vector<Chunk> split(std::string_view body, const std::string& file) {
  std::vector<Chunk> chunks;
  while (!body.empty()) {
    const std::string where = "GLB chunk " + std::to_string(chunks.size());
    if (body.size() < chunk_header_bytes) {
      throw InputError({file}, where, bytes_text(body.size()), "a chunk header of 8 bytes");
    }
    const size_t length = word(body, 0);
    if (length > body.size() - chunk_header_bytes) {
      throw InputError({file}, where, bytes_text(body.size() - chunk_header_bytes),
                       bytes_text(length) + " as its header says");
    }
    if (length % 4 != 0) {
      throw InputError({file}, where, "a length of " + bytes_text(length), "a multiple of 4");
    }
    chunks.push_back({word(body, 4), body.substr(chunk_header_bytes, length)});
    body.remove_prefix(chunk_header_bytes + length);
  }
  return chunks;
}

}  // namespace

Container open_container(std::string_view bytes, const std::string& file) {
  Container container;
  container.is_binary = bytes.starts_with("glTF") || file.ends_with(".glb");
  if (!container.is_binary) {
    container.json = bytes;
    return container;
  }
  const std::vector<Chunk> chunks = split(checked_body(bytes, file, &container.notices), file);
  if (chunks[0].type != json_chunk || chunks[0].data.empty()) {
    throw InputError({file}, "GLB chunk 0",
                     chunks[0].data.empty() ? "an empty chunk" : "a chunk of another type",
                     "JSON text");
  }
  container.json = chunks[0].data;
  for (size_t i = 1; i < chunks.size(); ++i) {
    const std::string where = "GLB chunk " + std::to_string(i);
    if (chunks[i].type == json_chunk || (chunks[i].type == bin_chunk && container.binary)) {
      throw InputError({file}, where, "a second chunk of its type", "at most one JSON and one BIN");
    }
    if (chunks[i].type != bin_chunk) {
      container.notices.push_back(where + " is of unknown type and ignored");
      continue;
    }
    if (i != 1) throw InputError({file}, where, "the BIN chunk", "it right after the JSON chunk");
    container.binary = chunks[i].data;
  }
  return container;
}

}  // namespace photorque::gltf
