// Bytes to which a glTF document refers. Only this part of the reader opens files.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/gltf/file/fault.h"

namespace photorque::gltf {

// `bytes` contains at least byte_length bytes. It is empty if the document does not state the
// source, which is legal for buffers that are not read (placeholders, fallbacks of compressed
// data).
struct Buffer {
  uint64_t byte_length = 0;
  std::optional<std::string> bytes;
};

struct Buffers {
  std::vector<Buffer> buffers;
  std::vector<std::pair<std::string, std::string>> inputs;  // external files: name, content hash
};

// Loads every buffer of a document that passed check_schema(). `binary` is the BIN chunk of a GLB.
// Throws InputError for bytes that are missing or fewer than declared, and for URIs that are
// malformed, of a scheme other than data:, absolute, or leave the folder of the model.
Buffers load_buffers(const nlohmann::json& document, std::optional<std::string_view> binary,
                     bool is_glb, const std::string& file, const GltfOpen& open,
                     MemoryBudget* budget);

// A JSON object with a `uri`.
struct UriHolder {
  const nlohmann::json& object;
  std::string where;                            // JSON pointer, for messages
  std::array<std::string_view, 2> media_types;  // allowed for embedded data
};

// Bytes of a URI: embedded data or a file. Throws InputError like load_buffers().
std::string load_uri(const UriHolder& holder, const std::string& file, const GltfOpen& open,
                     MemoryBudget* budget);

}  // namespace photorque::gltf
