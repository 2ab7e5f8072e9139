// Tests whether the surfaces of a scene are closed, or light can pass through cracks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "raytrace/scene.h"

namespace photorque {

// Counts over all meshes. Vertices at the same position count as one (exporters split them along
// creases and texture seams).
struct MeshClosure {
  size_t meshes = 0;
  size_t closed = 0;      // meshes whose edges all join two triangles
  size_t open_edges = 0;  // edges of one triangle only: rims of sheets, or cracks
  // Open edges on which a vertex of the same mesh lies (T-junctions): the triangles on both sides
  // do not share corners, so that rounding leaves gaps.
  size_t t_junctions = 0;
  // Meshes with fewer open edges than the square root of the number of edges, which is the minimum
  // for the rim of a square sheet: probably meant to be closed. (A disc of many rings also has
  // fewer; the count is used only for notices.)
  size_t almost_closed = 0;
  // Closed or almost closed meshes in which two neighbouring triangles have opposite front sides:
  // their inside is not defined.
  size_t with_turned_faces = 0;
  // Per mesh: closed or almost closed, with a volume and without turned faces.
  std::vector<uint8_t> encloses;
};

// Counts for all meshes. T-junctions are not searched in meshes with more than 100,000 open edges.
MeshClosure closure_of(const Scene& scene);

// One line of text if there are cracks or turned faces; empty for closed bodies and plain sheets.
std::string describe_closure(const MeshClosure& closure);

}  // namespace photorque
