// Scenes out as glTF 2.0: one self-contained file, the same bytes for the same input.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "core/transform.h"
#include "raytrace/scene.h"

namespace photorque {

// The appearance of a material (glTF's metallic-roughness model) and its optical properties.
struct GltfWriterMaterial {
  std::string name;
  Vec3 base_colour = Vec3::Constant(0.5);  // linear RGB in [0, 1]
  double metallic = 0.0;                   // in [0, 1]
  double roughness = 0.5;                  // in [0, 1]
  std::optional<SettingsNode> optics;      // written as they are to extras.photorque
};

// A node of the tree. Body frame; converted to glTF's +Y up on writing.
struct GltfWriterNode {
  std::string name;
  int parent = -1;  // index of an earlier node; −1: a root
  RigidTransform parent_from_node;
  int mesh = -1;      // index; −1: none
  int material = -1;  // of the mesh
  std::optional<SettingsNode> extras;
};

struct GltfWriterModel {
  std::vector<Mesh> meshes;
  std::vector<GltfWriterMaterial> materials;
  std::vector<GltfWriterNode> nodes;
  std::optional<SettingsNode> extras;  // of the asset
};

// The text of a .gltf file with its buffer embedded. Positions are rounded to float, as the format
// demands. A mesh that several nodes use with one material is stored once.
std::string gltf_text(const GltfWriterModel& model);

}  // namespace photorque
