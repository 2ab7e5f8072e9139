// Functions that build the benchmarks' scenes.
#pragma once

#include <string>
#include <utility>

#include "raytrace/scene.h"

namespace photorque {

// Adds a mesh and one instance of it, named `node`, at the origin.
inline void add_part(Scene& scene, Mesh mesh, const std::string& node) {
  Instance instance;
  instance.node = instance.path = node;
  instance.mesh = static_cast<uint32_t>(scene.meshes.size());
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back(instance);
}

}  // namespace photorque
