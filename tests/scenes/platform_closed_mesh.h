// Whether a mesh encloses a volume.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

#include "raytrace/scene.h"

namespace photorque {

// The fault of triangles that are not a closed surface with every edge once in each direction;
// empty if nothing does.
inline std::string fault_of_closed_mesh(const Mesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> uses;
  for (const auto& triangle : mesh.triangles) {
    for (size_t i = 0; i < 3; ++i) {
      const std::pair edge{triangle[i], triangle[(i + 1) % 3]};
      if (edge.first == edge.second) return "a triangle with two equal corners";
      if (++uses[edge] > 1) return "an edge twice in the same direction";
    }
  }
  for (const auto& [edge, count] : uses) {
    if (!uses.contains({edge.second, edge.first})) return "an open edge";
  }
  return uses.empty() ? "no triangles" : "";
}

}  // namespace photorque
