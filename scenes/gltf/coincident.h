// Faces that lie in each other: sheets drawn from both sides, parts back to back, doubled polygons.
//
// Two faces in one plane are one sheet to light. A ray meets whichever rounding puts first, and a
// quadrature over surfaces meets both. Therefore faces that lie in each other are set apart along
// their normals, in steps of 2e-6 of the scene's size (half the diagonal of its box): beyond the
// rounding of rays, below any feature.
// - Facing opposite ways: each moves towards its own front, so that light meets either from its own
//   side. Solids that touch stay as they are: no light gets between them.
// - Facing alike: one of them comes first, and shades the others: the outer one where their
//   distances differ, else an open sheet before a solid, else the first of the file. Light from
//   behind meets the back of the last, as with a foil on a panel.
//
// Light that passes through a face starts behind all faces that lie in it, by the depth of its
// part (Instance::sheet_depth_m): a sheet transmits by the face that light meets first.
//
// Faces that touch or cross at less than 5e-4 rad are apart by less than the rounding of rays
// over some width. They are cut where they cross, and set apart in the same way.
#pragma once

#include <string>
#include <vector>

#include "raytrace/scene.h"

namespace photorque {

// Separates overlapping faces that coincide within 1e-6 of the scene's size, in one part or in two,
// with equal or different corners. It also separates faces that touch or cross at a small angle.
// Meshes of several instances are copied if they differ afterwards. Returns one line for each of
// the few pairs of parts that coincide mostly.
std::vector<std::string> separate_coincident_faces(Scene& scene);

}  // namespace photorque
