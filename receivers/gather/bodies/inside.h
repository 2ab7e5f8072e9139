// Which side of a mesh no light from outside can reach.
#pragma once

#include <optional>
#include <span>

#include "receivers/surface_grid.h"

namespace photorque {

// Of a mesh without a gap: whether it is the fronts of its triangles that look inwards. Nothing of
// one that has an inside nowhere, or not everywhere on the same side: with an edge that belongs to
// other than two triangles, or to two that run along it the same way; of several bodies of which
// some are turned inside out; and of a body whose volume is nothing. Corners at the same place are
// one.
std::optional<bool> fronts_look_inwards(std::span<const SurfaceFace> faces);

}  // namespace photorque
