// A facet that is cut along shadows and mirror images. Triangles are divided recursively into
// quarters. For the files of this folder only.
//
// A point of a facet is given by the weights (u, v) of corners 1 and 2, a point of a cell by the
// weights of its three corners.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transform.h"
#include "receivers/gather/bodies/facets.h"

namespace photorque {

// Weights of three corners, whose sum is 1.
using CornerWeights = Vec3;

struct Cell {
  uint32_t level = 0;
  uint64_t path = 0;  // two bits per division, the last division in the lowest bits
  std::array<Vec2, 3> corner_uv = {Vec2(0.0, 0.0), Vec2(1.0, 0.0), Vec2(0.0, 1.0)};

  // Area as a fraction of the triangle.
  double share() const { return std::ldexp(1.0, -2 * static_cast<int>(level)); }
  Vec2 at(const CornerWeights& w) const {
    return w[0] * corner_uv[0] + w[1] * corner_uv[1] + w[2] * corner_uv[2];
  }
  Vec2 centre() const { return (corner_uv[0] + corner_uv[1] + corner_uv[2]) / 3.0; }
  // Quarters 0, 1 and 2 are at the corners, quarter 3 is in the middle.
  Cell quarter(uint32_t which) const {
    const auto& [a, b, c] = corner_uv;
    const Vec2 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    const std::array<std::array<Vec2, 3>, 4> corners = {
        {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {bc, ca, ab}}};
    return {level + 1, 4 * path + which, corners[which]};
  }
};

// Converts the weights of a point in a cell to its weights in a quarter.
inline CornerWeights in_quarter(const CornerWeights& w, uint32_t which) {
  if (which == 3) return CornerWeights::Ones() - 2.0 * w;
  CornerWeights own = 2.0 * w;
  own[which] -= 1.0;
  return own;
}

// The quarter that contains a point.
inline uint32_t quarter_of(const CornerWeights& w) {
  return w[0] >= 0.5 ? 0 : w[1] >= 0.5 ? 1 : w[2] >= 0.5 ? 2 : 3;
}

// A straight line in the body frame.
struct Line {
  Vec3 from_m, to_m;
};

// A line projected on a facet, in the weights of its corners.
struct Trace {
  CornerWeights from, to;
  double height_m = 0.0;  // height of its lowest point above the facet
};

// Whether a trace meets a cell or comes closer to it than `margin`, in the cell's weights.
inline bool meets(const Trace& trace, double margin) {
  for (int k = 0; k < 3; ++k) {
    if (trace.from[k] <= -margin && trace.to[k] <= -margin) return false;
  }
  // Signed distances of the corners (0, 0), (1, 0), (0, 1) from the line, times its length.
  const double x = trace.to[1] - trace.from[1], y = trace.to[2] - trace.from[2];
  const double at_0 = y * trace.from[1] - x * trace.from[2], at_1 = at_0 - y, at_2 = at_0 + x;
  const double far = margin * (std::abs(x) + std::abs(y));
  return std::max({at_0, at_1, at_2}) > -far && std::min({at_0, at_1, at_2}) < far;
}

// Converts a trace to the weights of a quarter.
inline Trace in_quarter(const Trace& trace, uint32_t which) {
  return {in_quarter(trace.from, which), in_quarter(trace.to, which), trace.height_m};
}

// A part of a facet.
struct Piece {
  Cell cell;     // the cell that contains it
  double share;  // fraction of the facet's area
  Vec2 centre_uv;
  bool whole;  // the piece is the cell itself
};

// Minimum levels of cells that no trace meets, and of the others.
struct Levels {
  uint32_t finest = 0, along_traces = 0;
};

// Lines within the fraction `plane_rounding` of the scene's size are in a facet's plane. Pieces
// below the fraction `least_piece` of the total area are not cut further.
inline constexpr double plane_rounding = 1e-7, least_piece = 1e-6;

// A facet and the lines on it at which its illumination or its view changes.
class Screen {
 public:
  explicit Screen(const Facet& facet);

  // Adds the traces of all lines in front of one side, for parallel light that arrives along
  // `travel`. They are the edges of shadows, or of the view from this side against `travel`.
  void add(std::span<const Line> lines, const Vec3& normal, const Vec3& travel, double rounding_m);
  // Cuts the facet along the traces. The illumination and view of a piece are uniform, except in
  // cells smaller than `least_m2`, which are not cut.
  void cut(Levels levels, double least_m2, std::vector<Piece>& pieces) const;
  const std::vector<Trace>& traces() const { return traces_; }

 private:
  double area_m2_;
  Vec3 corner_m_, u_per_m_, v_per_m_;
  std::vector<Trace> traces_;
};

}  // namespace photorque
