#include "scenes/gltf/file/compression.h"

#include "scenes/gltf/file/fault.h"

namespace photorque::gltf {

using nlohmann::json;

void decompress(Document* document, MemoryBudget* budget) {
  // First, because Draco data may lie in a view that it decodes.
  decode_meshopt_views(document, budget);
  decode_draco_primitives(document, budget);
}

uint64_t extension_number(const Document& document, const json& extension, const char* key,
                          const std::string& where) {
  const json* const found = member_of(extension, key);
  constexpr uint64_t largest = 1ull << 53;
  if (!found || !found->is_number_unsigned() || found->get<uint64_t>() > largest) {
    throw document.wrong(where + pointer(key), found ? describe_json(*found) : "nothing",
                         "a whole number");
  }
  return found->get<uint64_t>();
}

std::span<const unsigned char> buffer_bytes(const Document& document, uint64_t buffer,
                                            uint64_t offset, uint64_t length,
                                            const std::string& where) {
  if (buffer >= document.buffers.size() || !document.buffers[buffer].bytes) {
    throw document.wrong(where, "buffer " + std::to_string(buffer) + " without bytes",
                         "a buffer that holds the compressed data");
  }
  const std::string& bytes = *document.buffers[buffer].bytes;
  if (offset > bytes.size() || length > bytes.size() - offset) {
    throw document.wrong(where,
                         std::to_string(length) + " bytes from byte " + std::to_string(offset),
                         "an end within the " + std::to_string(bytes.size()) + " of the buffer");
  }
  return {reinterpret_cast<const unsigned char*>(bytes.data()) + offset, length};
}

size_t add_buffer(Document* document, std::string bytes) {
  document->json["buffers"].push_back(json{{"byteLength", bytes.size()}});
  const uint64_t length = bytes.size();
  document->buffers.push_back({length, std::move(bytes)});
  return document->buffers.size() - 1;
}

}  // namespace photorque::gltf
