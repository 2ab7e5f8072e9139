// Separation of coincident faces: sheets drawn from both sides, parts back to back, duplicated
// polygons.
//
// Light must meet two faces in one plane as a single sheet. Without separation, rounding decides
// which face a ray meets, and a quadrature over surfaces counts both. Therefore coincident faces
// are displaced along their normals in steps of 2e-6 of the scene's size (half the diagonal of its
// box). A step is larger than the rounding of rays and smaller than any feature.
// - Opposite orientation: each face moves towards its own front, so that light meets each from its
// own side. Solids that touch are not changed, because no light gets between them.
// - Equal orientation: one face comes first and shades the others. It is the outer one if their
// distances differ, else an open sheet before a solid, else the first in the file. Light from
// behind meets the back of the last, as for a foil on a panel.
//
// Light that passes through a face starts behind all faces that coincide with it, by the depth of
// its part (Instance::sheet_depth_m): the face that light meets first determines the transmission.
//
// Faces that touch or cross at less than 5e-4 rad are closer than the rounding of rays over some
// width. They are cut where they cross, and separated in the same way.
#pragma once

#include <string>
#include <vector>

#include "raytrace/scene.h"

namespace photorque {

// Separates overlapping faces that coincide within 1e-6 of the scene's size, in one part or in two,
// with equal or different corners; also faces that touch or cross at a small angle. Meshes of
// several instances are copied if they differ afterwards. Returns one line for each pair of parts
// that coincide over most of their area, for a few pairs at most.
std::vector<std::string> separate_coincident_faces(Scene& scene);

}  // namespace photorque
