// Division of a convex polygon by a straight line or a plane.
#pragma once

#include <cstddef>
#include <span>

namespace photorque {

// Calls take(corner, side) for the corners of the two parts of a polygon, in their order. The part
// in front of the line (plane) has side > 0, the other one side < 0. Corners on it, among them the
// new ones where edges cross it, have side 0 and belong to both parts. `side_of` is linear in the
// coordinates of a corner; corners are vectors of Eigen.
// Source: I. E. Sutherland, G. W. Hodgman, "Reentrant polygon clipping", Comm. ACM 17 (1974).
template <class Corner, class SideOf, class Take>
void divide_convex(std::span<const Corner> polygon, const SideOf& side_of, const Take& take) {
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Corner& a = polygon[i];
    const Corner& b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
    const double from = side_of(a), to = side_of(b);
    take(a, from);
    if ((from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0)) {
      take(Corner(a + from / (from - to) * (b - a)), 0.0);
    }
  }
}

}  // namespace photorque
