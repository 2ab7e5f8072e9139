// How much of a triangle lies in each cell of a grid.
#pragma once

#include <array>
#include <functional>
#include <span>

#include "core/transform.h"

namespace photorque {

// Cuts a triangle along the lines of a grid of unit cells [0, width] × [0, height] and calls
// `add(column, row, fraction)` with the fraction of the triangle's area in each cell it meets. The
// fractions are ≥ 0 and sum to 1 within a few roundings, also for a triangle that the grid sees
// edge-on. `corners` are in units of cells; what is outside counts for the nearest cell.
//
// Method: I. E. Sutherland and G. W. Hodgman, "Reentrant polygon clipping", Comm. ACM 17 (1974),
// first into columns and then into rows, on polygons that carry barycentric coordinates, in which
// areas are measured.
void split_over_cells(const std::array<Vec2, 3>& corners, int width, int height,
                      const std::function<void(int, int, double)>& add);

// The same pieces themselves: add(column, row, corners of a convex polygon), each corner by its
// weights of the triangle's corners 1 and 2.
void clip_to_cells(const std::array<Vec2, 3>& corners, int width, int height,
                   const std::function<void(int, int, std::span<const Vec2>)>& add);

}  // namespace photorque
