// A glTF file in memory: parsed, of the right shape, with its bytes. What the other parts of the
// reader work on.
#pragma once

// The one way in which this program sees tinygltf: without image decoding and without access to
// files. Textures cannot matter to a tracer of light in bands, and whatever a model makes us open
// is opened (and recorded) by buffers.h alone. The macros change the class, so every source file
// must see the same ones.
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
  nlohmann::json json;    // as written, without the sections that are not needed
  tinygltf::Model model;  // as typed objects; without buffers, images, textures, animations
  std::vector<Buffer> buffers;
  std::vector<std::pair<std::string, std::string>> inputs;  // external files: name, content hash
  std::vector<std::string> notices;

  // The error for a wrong value at a JSON pointer of this document.
  InputError wrong(const std::string& where, const std::string& found,
                   const std::string& expected) const {
    return {{file}, where, found, expected};
  }
};

// Parses and checks the shape of a file, loads its buffers. Throws InputError, see
// open_container(), check_schema(), load_buffers(); also for JSON that does not parse (with its
// line), nests deeper than 64 levels, is of a glTF version other than 2, or requires an extension
// that may change geometry and is not supported. Ranges inside the bytes are not checked here but
// by gltf_validation.
Document read_document(const std::string& bytes, const std::string& file, const GltfOpen& open,
                       MemoryBudget* budget);

// Element `index` (of any JSON type, as found at the pointer `where`) of a section of the document.
// Throws InputError for an index that is none.
const nlohmann::json& element_of(const Document& document, const std::string& where,
                                 const nlohmann::json& index, const char* section);

// The bytes of a buffer view, likewise.
std::string bytes_of_view(const Document& document, const std::string& where,
                          const nlohmann::json& index);

}  // namespace photorque::gltf
