// Separation of coincident faces: sheets drawn from both sides, parts back to back, duplicated
// polygons.
//
// Light must meet two faces in one plane as a single sheet. Without separation, rounding decides
// which face a ray meets, and a quadrature over surfaces counts both. Therefore coincident faces
// are displaced along their normals until they are 2e-6 of the scene's size apart (half the
// diagonal of its box). This is larger than the rounding of rays and smaller than any feature.
// - Opposite orientation: each face moves towards its own front, so that light meets each from its
// own side. Solids that touch are not changed if both are opaque, because no light gets between
// them. Otherwise a gap is made between them, through which the light passes.
// - Equal orientation: one face comes first and shades the others. It is the outer one if their
// distances differ. For faces in one plane it is an open sheet before a solid, a transparent face
// before an opaque one, the part with the smaller area, else the first in the file. Light from
// behind meets the back of the last, as for a foil on a panel. The order is the same for all faces
// of two parts in one plane, because rounded corners lie partly in front, partly behind.
//
// Transparent faces that coincide are one sheet: light that passes through one of them starts
// behind the others, by the depth of its part (Instance::sheet_depth_m), and the face that light
// meets first determines the transmission. Opaque faces are farther away than this depth.
//
// Faces that touch or cross at less than 5e-4 rad are closer than the rounding of rays over some
// width. They are cut where they cross, and separated in the same way.
#pragma once

#include <string>
#include <vector>

#include "raytrace/scene.h"

namespace photorque {

// Separates overlapping faces that coincide within 3e-5 of the scene's size, in one part or in two,
// with equal or different corners; also faces that touch or cross at a small angle. Meshes of
// several instances are copied if they differ afterwards. Returns one line for each pair of parts
// that coincide over most of their area, for a few pairs at most, and one for each pair whose faces
// cross nearly in one plane.
std::vector<std::string> separate_coincident_faces(Scene& scene);

}  // namespace photorque
