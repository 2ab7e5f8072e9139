// EXT_mesh_gpu_instancing: one node that repeats its mesh.
#pragma once

#include <vector>

#include "core/transform.h"
#include "scenes/gltf/file/document.h"

namespace photorque::gltf {

// The places of a node's mesh, relative to the node: one identity, or one per instance of the
// extension, from its attributes TRANSLATION (VEC3 of float), ROTATION (VEC4 of float, or of
// normalized signed bytes or shorts) and SCALE (VEC3 of float), each optional.
// Source: KhronosGroup/glTF, extensions/2.0/Vendor/EXT_mesh_gpu_instancing.
// Throws InputError for attributes of other types or of different counts, and for instances that
// are not invertible.
std::vector<Affine> gpu_instances(const Document& document, int node, MemoryBudget* budget);

}  // namespace photorque::gltf
