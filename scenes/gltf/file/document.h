// A glTF file in memory: parsed, checked against the schema, with its bytes. The other parts of the
// reader work on it.
#pragma once

// The only include of tinygltf, configured without image decoding and without access to files:
// tracing needs no textures, and only buffers.h opens (and records) files of a model. The macros
// change the class, so every source file must include it with the same ones.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS

#include <tiny_gltf.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "scenes/gltf/file/buffers.h"
#include "scenes/gltf/file/fault.h"

namespace photorque::gltf {

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

}  // namespace photorque::gltf
