// Faces with more than three corners as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/transform.h"

namespace photorque::cad {

// The triangles of a polygon without holes, as places in `corners`, in its own order of corners. A
// polygon that is not quite plane is cut as it is seen along its mean normal (Newell's); one that
// crosses itself gives some triangles that overlap. Fewer than three corners give none; corners in
// one line give triangles without area.
// Source: D. Eberly, "Triangulation by Ear Clipping" (2002).
std::vector<std::array<uint32_t, 3>> triangles_of(const std::vector<Vec3>& corners);

}  // namespace photorque::cad
