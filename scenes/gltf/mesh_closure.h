// Whether the surfaces of a scene are closed: where light can slip through that should not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "raytrace/scene.h"

namespace photorque {

// Counts over all meshes. Vertices at the same place count as one (exporters split them along
// creases and seams of texture).
struct MeshClosure {
  size_t meshes = 0;
  size_t closed = 0;      // meshes whose every edge joins two triangles
  size_t open_edges = 0;  // of one triangle only: rims of sheets, or cracks
  // Open edges on which a vertex of the same mesh lies: the triangles on both sides do not meet at
  // the same corners, so that rounding leaves gaps (T-junctions).
  size_t t_junctions = 0;
  // Meshes with open edges, but fewer than the root of all edges, which the rim of a square sheet
  // has at least: meant to be closed, it seems. (Not of every sheet: of a disc in many rings the
  // rim has fewer. For notices alone.)
  size_t almost_closed = 0;
  std::vector<uint8_t> encloses;  // per mesh: closed or almost, round a volume
};

// Meshes with more than 100,000 open edges are not searched for T-junctions.
MeshClosure closure_of(const Scene& scene);

// One line of text when there are cracks; empty for closed bodies and plain sheets.
std::string describe_closure(const MeshClosure& closure);

}  // namespace photorque
