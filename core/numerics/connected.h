// Connected sets: points at one position, and members that are joined in pairs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/transform.h"

namespace photorque {

// For every point the index of one point at the same position, equal for all points there.
inline std::vector<uint32_t> welded(std::span<const Vec3> points) {
  std::vector<uint32_t> order(points.size()), one(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, [&](uint32_t a, uint32_t b) {
    return std::lexicographical_compare(points[a].data(), points[a].data() + 3, points[b].data(),
                                        points[b].data() + 3);
  });
  for (size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && points[order[i]] == points[order[i - 1]];
    one[order[i]] = same ? one[order[i - 1]] : order[i];
  }
  return one;
}

// Disjoint sets of the members 0 … count − 1. The root of a set is its lowest member.
class DisjointSets {
 public:
  explicit DisjointSets(size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), size_t{0});
  }
  size_t root(size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(size_t a, size_t b) {
    const size_t i = root(a), j = root(b);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<size_t> parent_;
};

}  // namespace photorque
