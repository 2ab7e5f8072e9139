// Lines at which shadows in parallel light can end. For the files of this folder only.
#pragma once

#include <vector>

#include "receivers/gather/bodies/partition.h"

namespace photorque {

// The edges of all facets, each once, with the normals of the facets that meet there.
class Outlines {
 public:
  explicit Outlines(const Facets& facets);

  // Edges at which the surface ends or turns away from light along `travel`; only these bound
  // shadows. With `creases`, also sharp edges: together the lines where the view against `travel`
  // changes.
  std::vector<Line> in_light(const Vec3& travel, bool creases = false) const;

 private:
  struct Edge {
    Line line;
    Vec3 normal[2];
    int facets = 0;
  };
  std::vector<Edge> edges_;
};

// The facets of a scene, and the lines that bound shadows on them.
struct BodyShape {
  explicit BodyShape(const TraceableScene& scene);

  Facets facets;
  Outlines outlines;
  std::vector<std::vector<Line>> cuts;  // by facet: the lines at which others cut through it
};

// A grid of lines, projected along the light's direction `travel`, for fast search of the lines
// over a facet.
class LineGrid {
 public:
  // The outlines in light that travels along `travel`.
  LineGrid(const TraceableScene& scene, const Outlines& outlines, const Vec3& travel);

  const std::vector<Line>& lines() const { return lines_; }
  // Finds the lines that may pass over or under a triangle.
  void over(const TriangleCorners& corners_m, std::vector<Line>& found);

 private:
  static constexpr int width = 48;
  static size_t cell(int column, int row) {
    return static_cast<size_t>(column) * width + static_cast<size_t>(row);
  }
  int column(double x_m) const;
  // Across the light, from the middle of the ball.
  Vec2 seen(const Vec3& at_m) const {
    return {across_.dot(at_m - centre_m_), aside_.dot(at_m - centre_m_)};
  }
  void add(uint32_t index);

  std::vector<Line> lines_;
  Vec3 centre_m_, across_, aside_;
  double low_m_, per_m_;
  std::vector<std::vector<uint32_t>> cells_;
  std::vector<uint32_t> seen_;  // number of the query that found it last
  uint32_t question_ = 0;
};

}  // namespace photorque
