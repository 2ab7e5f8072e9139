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

// Whether every edge belongs to exactly two triangles that traverse it in opposite directions.
// `corners` are three numbers per triangle, equal at one position; see welded(). A triangle with
// two equal corners has no area, and its neighbours share the remaining edge.
inline bool edges_pair_up(std::span<const uint32_t> corners) {
  struct Edge {
    uint32_t low, high;
    bool forward;  // from the lower to the higher number
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  for (size_t first = 0; first < corners.size(); first += 3) {
    const auto p = corners.subspan(first, 3);
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = p[k], b = p[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::ranges::sort(edges);
  if (edges.empty() || edges.size() % 2 != 0) return false;
  for (size_t i = 0; i < edges.size(); i += 2) {
    const Edge &a = edges[i], &b = edges[i + 1];
    const bool is_pair = a.low == b.low && a.high == b.high && a.forward != b.forward;
    const bool is_more = i > 0 && edges[i - 1].low == a.low && edges[i - 1].high == a.high;
    if (!is_pair || is_more) return false;
  }
  return true;
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
