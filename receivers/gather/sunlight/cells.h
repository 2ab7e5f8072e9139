// A triangle cut into quarters again and again. For the files of this folder only.
//
// Points are told by the weights of the corners 1 and 2, (u, v); of a cell, by the weights of its
// own three corners.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/transform.h"

namespace photorque {

// Weights of three corners, whose sum is 1.
using CornerWeights = Vec3;

struct Cell {
  uint32_t level = 0;
  uint64_t path = 0;  // two bits for each cut, the last one lowest
  std::array<Vec2, 3> corner_uv = {Vec2(0.0, 0.0), Vec2(1.0, 0.0), Vec2(0.0, 1.0)};

  // Of the triangle's area.
  double share() const { return std::ldexp(1.0, -2 * static_cast<int>(level)); }
  Vec2 at(const CornerWeights& w) const {
    return w[0] * corner_uv[0] + w[1] * corner_uv[1] + w[2] * corner_uv[2];
  }
  Vec2 centre() const { return (corner_uv[0] + corner_uv[1] + corner_uv[2]) / 3.0; }
  // At the corners 0, 1 and 2, then the one between.
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

}  // namespace photorque
