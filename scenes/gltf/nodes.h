// The node hierarchy of a glTF document: the placement of its meshes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/transform.h"
#include "scenes/gltf/file/document.h"

namespace photorque::gltf {

// The local transform of a node, from its matrix or from translation · rotation · scale (section
// 3.5.2). The rotation is normalised.
Affine parent_from_node(const tinygltf::Node& node);

// Whether a quaternion has unit length within 1 %; normalised bytes have an error of up to 0.8 %.
bool is_unit(const Quat& rotation);

// Whether the transform is finite and its three axes are nonzero and (to 1e-12) not in one plane.
// The lengths of the axes may differ.
bool is_invertible(const Affine& transform);

// A placed mesh in the world of the file (glTF axes and units).
struct Placement {
  int node = 0;
  int mesh = 0;
  std::string name;  // of the node, "node_7" if it has none
  std::string path;  // names from the root to the node, joined by "/"
  Affine world_from_mesh = Affine::Identity();
};

// A node of the default scene on the way from the root.
struct NodeVisit {
  int node = 0;
  size_t depth = 1;
  std::string path;  // names from the root to the node, joined by "/"; "node_7" if it has none
  Affine world_from_node = Affine::Identity();
};

// Calls `visit` for every node of the default scene, parents first. Errors as in place_meshes().
void visit_nodes(const Document& document, MemoryBudget* budget,
                 const std::function<void(const NodeVisit&)>& visit);

// Every mesh of the default scene, in depth-first order: scene `scene`, else scene 0, else (no
// scenes) everything below all root nodes. A node with EXT_mesh_gpu_instancing gives one placement
// per instance. The document must have passed validate_nodes() and validate_accessors(). Throws
// InputError for hierarchies deeper than 1000 nodes, for products of transforms that are singular
// or overflow, for skinned meshes and for morph targets whose weights are not zero.
std::vector<Placement> place_meshes(const Document& document, MemoryBudget* budget);

// EXT_mesh_gpu_instancing: one node with several instances of its mesh.

// Transforms of the instances of a node's mesh, relative to the node: one identity, or one per
// instance of the extension. They come from its attributes TRANSLATION (VEC3 of float), ROTATION
// (VEC4 of float, or of normalized signed bytes or shorts) and SCALE (VEC3 of float), each
// optional.
// Source: KhronosGroup/glTF, extensions/2.0/Vendor/EXT_mesh_gpu_instancing.
// Throws InputError for attributes of other types or of different counts, and for instances that
// are not invertible.
std::vector<Affine> gpu_instances(const Document& document, int node, MemoryBudget* budget);

}  // namespace photorque::gltf
