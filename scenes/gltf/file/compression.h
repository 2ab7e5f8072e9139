// Replaces compressed geometry of a glTF document by plain geometry.
#pragma once

#include <cstdint>
#include <string>

#include "scenes/gltf/file/document.h"

namespace photorque::gltf {

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
