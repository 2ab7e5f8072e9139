// A facet cut along shadows and mirror images. For the files of this folder only.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "receivers/gather/bodies/facets.h"
#include "receivers/gather/sunlight/cells.h"

namespace photorque {

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

// The same in the weights of a quarter.
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
