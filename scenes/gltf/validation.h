// Faults in a glTF document whose shape is right.
#pragma once

#include "scenes/gltf/file/document.h"

namespace photorque::gltf {

// Throws InputError for the first of:
//   bufferViews that leave their buffer, with a stride longer than they are or beside target
//   ELEMENT_ARRAY_BUFFER;
//   accessors that leave their bufferView, misaligned, with a stride shorter than their elements,
//   with `normalized` on floats, sparse parts that do not fit.
// After it, every element of every accessor lies inside the declared length of its buffer.
void validate_accessors(const Document& document);

// Throws InputError for the first primitive whose geometry cannot be read: POSITION, TEXCOORD_0 or
// indices of a type that the specification does not allow, attributes of different counts, a number
// of corners that does not make triangles. Other attributes and morph targets are not looked at.
void validate_primitives(const Document& document);

// Throws InputError for the first of: a node with two parents, or twice among the roots of a scene;
// a node below itself; a root of a scene that is a child; a transform that is singular (a zero
// scale), has a last row other than (0, 0, 0, 1), or a rotation that is no unit quaternion.
void validate_nodes(const Document& document);

}  // namespace photorque::gltf
