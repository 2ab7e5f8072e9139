// Validation of a glTF document that matches the schema.
#pragma once

#include "scenes/gltf/file/document.h"

namespace photorque::gltf {

// Throws InputError for the first of:
//   a bufferView that exceeds its buffer, has a stride longer than itself, or has a stride together
//   with the target ELEMENT_ARRAY_BUFFER;
//   an accessor that exceeds its bufferView, is misaligned, has a stride shorter than its elements,
//   has `normalized` on floats, or has sparse parts that do not fit.
// Afterwards every element of every accessor lies inside the declared length of its buffer.
void validate_accessors(const Document& document);

// Throws InputError for the first primitive whose geometry cannot be read: POSITION, TEXCOORD_0 or
// indices of a type that the specification does not allow, attributes of different counts, or a
// number of corners that does not make triangles. Other attributes and morph targets are not
// checked.
void validate_primitives(const Document& document);

// Throws InputError for the first of: a node with two parents, or twice among the roots of a scene;
// a node below itself; a root of a scene that is a child; a transform that is singular (a zero
// scale) or has a last row other than (0, 0, 0, 1); a rotation that is not a unit quaternion.
void validate_nodes(const Document& document);

}  // namespace photorque::gltf
