// A facet cut along shadows and mirror images: triangles cut into quarters again and again. For the
// files of this folder only.
//
// Points are given by the weights of the corners 1 and 2, (u, v); of a cell, by the weights of its
// three corners.
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
  uint64_t path = 0;  // two bits for each cut, the last one lowest
  std::array<Vec2, 3> corner_uv = {Vec2(0.0, 0.0), Vec2(1.0, 0.0), Vec2(0.0, 1.0)};

  // Area as a fraction of the triangle.
  double share() const { return std::ldexp(1.0, -2 * static_cast<int>(level)); }
  Vec2 at(const CornerWeights& w) const {
    return w[0] * corner_uv[0] + w[1] * corner_uv[1] + w[2] * corner_uv[2];
  }
  Vec2 centre() const { return (corner_uv[0] + corner_uv[1] + corner_uv[2]) / 3.0; }
  // The quarters at the corners 0, 1 and 2, then the one in the middle.
  Cell quarter(uint32_t which) const {
    const auto& [a, b, c] = corner_uv;
    const Vec2 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    const std::array<std::array<Vec2, 3>, 4> corners = {
        {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {bc, ca, ab}}};
    return {level + 1, 4 * path + which, corners[which]};
  }
};

// A cell's weights of a point as those of one of its quarters.
inline CornerWeights in_quarter(const CornerWeights& w, uint32_t which) {
  if (which == 3) return CornerWeights::Ones() - 2.0 * w;
  CornerWeights own = 2.0 * w;
  own[which] -= 1.0;
  return own;
}

// The quarter that holds a point.
inline uint32_t quarter_of(const CornerWeights& w) {
  return w[0] >= 0.5 ? 0 : w[1] >= 0.5 ? 1 : w[2] >= 0.5 ? 2 : 3;
}

// Body frame.
struct Line {
  Vec3 from_m, to_m;
};

// A line on a facet, in the weights of its corners.
struct Trace {
  CornerWeights from, to;
  double height_m = 0.0;  // of its lowest point above the facet
};

// Whether a trace meets a cell, or comes nearer to it than `margin`, in the cell's weights.
inline bool meets(const Trace& trace, double margin) {
  for (int k = 0; k < 3; ++k) {
    if (trace.from[k] <= -margin && trace.to[k] <= -margin) return false;
  }
  // The corners (0, 0), (1, 0), (0, 1) from the line.
  const double x = trace.to[1] - trace.from[1], y = trace.to[2] - trace.from[2];
  const double at_0 = y * trace.from[1] - x * trace.from[2], at_1 = at_0 - y, at_2 = at_0 + x;
  const double far = margin * (std::abs(x) + std::abs(y));
  return std::max({at_0, at_1, at_2}) > -far && std::min({at_0, at_1, at_2}) < far;
}

// The trace in the weights of a quarter.
inline Trace in_quarter(const Trace& trace, uint32_t which) {
  return {in_quarter(trace.from, which), in_quarter(trace.to, which), trace.height_m};
}

// A part of a facet.
struct Piece {
  Cell cell;     // that holds it
  double share;  // of the facet's area
  Vec2 centre_uv;
  bool whole;  // the cell itself
};

// The levels of cells at least: of those that no trace meets, and of others.
struct Levels {
  uint32_t finest = 0, along_traces = 0;
};

// Lines within this fraction of the scene's size are in a facet's plane; pieces below this fraction
// of the total area are not cut further.
inline constexpr double plane_rounding = 1e-7, least_piece = 1e-6;

// A facet with the lines on it at which something begins or ends for it.
class Screen {
 public:
  explicit Screen(const Facet& facet);

  // The traces of all lines before one side along parallel light that comes to it along `travel`:
  // the edges of shadows, or of what is seen from there against that direction.
  void add(std::span<const Line> lines, const Vec3& normal, const Vec3& travel, double rounding_m);
  // Cuts the facet along the traces. Nothing begins or ends within a piece, but in cells smaller
  // than `least_m2`, which are not cut.
  void cut(Levels levels, double least_m2, std::vector<Piece>& pieces) const;
  const std::vector<Trace>& traces() const { return traces_; }

 private:
  double area_m2_;
  Vec3 corner_m_, u_per_m_, v_per_m_;
  std::vector<Trace> traces_;
};

}  // namespace photorque
