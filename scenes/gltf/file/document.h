// A glTF file in memory: parsed, checked against the schema, with its bytes. The other parts of the
// reader work on it.
#pragma once

// The only include of tinygltf, configured without image decoding and without access to files:
// tracing needs no textures, and only buffers.cpp opens (and records) files of a model. The macros
// change the class, so every source file must include it with the same ones.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS

#include <tiny_gltf.h>

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/gltf/file/fault.h"
#include "scenes/gltf/file/open.h"

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

struct Document {
  std::string file;       // name in messages
  nlohmann::json json;    // as in the file, without the sections that are not needed
  tinygltf::Model model;  // as typed objects; without buffers, images, textures, animations
  std::vector<Buffer> buffers;
  std::vector<std::pair<std::string, std::string>> inputs;  // external files: name, content hash
  std::vector<std::string> notices;

  // Error for a wrong value at a JSON pointer of this document.
  InputError wrong(const std::string& where, const std::string& found,
                   const std::string& expected) const {
    return {{file}, where, found, expected};
  }
};

// Parses a file, checks its schema and loads its buffers. Throws InputError, see open_container(),
// check_schema(), load_buffers(). Throws it also for JSON that cannot be parsed (with its line), is
// nested deeper than 64 levels, has a glTF version other than 2, or requires an unsupported
// extension that may change geometry. Ranges of bytes are checked by validate_accessors(), not
// here.
Document read_document(const std::string& bytes, const std::string& file, const GltfOpen& open,
                       MemoryBudget* budget);

// Element `index` (any JSON value, found at the pointer `where`) of a section of the document.
// Throws InputError if it is not a valid index.
const nlohmann::json& element_of(const Document& document, const std::string& where,
                                 const nlohmann::json& index, const char* section);

// Bytes of a buffer; valid until a buffer is added. Throws InputError if some of them are missing.
std::string_view buffer_bytes(const Document& document, uint64_t buffer, uint64_t offset,
                              uint64_t length, const std::string& where);
// Bytes of the buffer view `index`; errors as in element_of() and buffer_bytes().
std::string_view bytes_of_view(const Document& document, const std::string& where,
                               const nlohmann::json& index);

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

// Decode EXT_meshopt_compression (buffer views) and KHR_draco_mesh_compression (primitives), so
// that other parts of the reader need not handle them. The decoded bytes become additional buffers
// of the document, with their own views and accessors. Call both before the typed model is made,
// views first, because Draco data may lie in one of them.
//
// A primitive with Draco data keeps its plain accessors if they have bytes. Otherwise it gets
// POSITION, TEXCOORD_0 and indices from the data, and no other attribute. Throw InputError for data
// that cannot be decoded or that contradict their description in the document; `where` in messages
// is the extension.
void decode_meshopt_views(Document* document, MemoryBudget* budget);
void decode_draco_primitives(Document* document, MemoryBudget* budget);

// An unsigned integer below 2^53 of an extension that check_schema() does not cover. Throws
// InputError for other values.
uint64_t extension_number(const Document& document, const nlohmann::json& extension,
                          const char* key, const std::string& where);

// Adds a buffer to the document; returns its index.
size_t add_buffer(Document* document, std::string bytes);

}  // namespace photorque::gltf
