// Writes scenes as glTF 2.0: one self-contained file, with equal bytes for equal input.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "core/transform.h"
#include "raytrace/scene.h"

namespace photorque {

// A material, drawn grey.
struct GltfWriterMaterial {
  std::string name;
  std::optional<SettingsNode> optics;  // written unchanged to extras.photorque
};

// A node of the tree. Body frame; converted to glTF's +Y up on writing.
struct GltfWriterNode {
  std::string name;
  int parent = -1;                    // index of an earlier node; −1: a root
  Vec3 translation_m = Vec3::Zero();  // relative to its parent
  int mesh = -1;                      // index; −1: none
  int material = -1;                  // of the mesh
};

struct GltfWriterModel {
  std::vector<Mesh> meshes;
  std::vector<GltfWriterMaterial> materials;
  std::vector<GltfWriterNode> nodes;
  // Adds what single precision leaves of the positions, as gltf::position_rest.
  bool exact_positions = false;
};

// Text of a .gltf file with embedded buffer. Positions are rounded to float, as the format
// requires. A mesh that several nodes use with the same material is stored once.
std::string gltf_text(const GltfWriterModel& model);

}  // namespace photorque
