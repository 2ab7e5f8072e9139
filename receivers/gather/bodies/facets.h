// The triangles of a body as light meets them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "raytrace/scene.h"
#include "raytrace/tracing/shadow.h"
#include "receivers/surface_grid.h"

namespace photorque {

// A triangle of positive area. Body frame.
struct Facet {
  TriangleCorners corner_m;
  Vec3 normal;  // of the front
  double area_m2 = 0.0;
  Ball ball;  // about its centroid
  uint32_t instance = 0;
  uint32_t triangle = 0;
  // Nothing of the scene lies above the back [0] or the front [1]: whatever comes to that side is
  // not shaded.
  std::array<bool, 2> free = {false, false};
};

// All facets of a scene, instance by instance.
class Facets {
 public:
  explicit Facets(const Scene& scene);

  std::span<const Facet> of(uint32_t instance) const {
    return std::span(facets_).subspan(first_[instance], first_[instance + 1] - first_[instance]);
  }
  std::span<const Facet> all() const { return facets_; }
  uint32_t instances() const { return static_cast<uint32_t>(balls_.size()); }
  // The place in all() of each triangle of each instance; of one without area, of its neighbour.
  const std::vector<std::vector<uint32_t>>& numbers() const { return numbers_; }
  // Holds an instance.
  const Ball& ball_of(uint32_t instance) const { return balls_[instance]; }
  size_t count() const { return facets_.size(); }
  // Of an instance without a gap: whether it is the fronts that look inwards
  // (fronts_look_inwards()).
  std::optional<bool> inward(uint32_t instance) const { return inward_[instance]; }

 private:
  void find_free(double scene_radius_m);

  std::vector<Facet> facets_;
  std::vector<size_t> first_;
  std::vector<std::vector<uint32_t>> numbers_;
  std::vector<Ball> balls_;
  std::vector<std::optional<bool>> inward_;
};

// Which side of a mesh no light from outside can reach.

// Of a mesh without a gap: whether it is the fronts of its triangles that look inwards. Nothing of
// one that has an inside nowhere, or not everywhere on the same side: with an edge that belongs to
// other than two triangles, or to two that run along it the same way; of several bodies of which
// some are turned inside out; and of a body whose volume is nothing. Corners at the same place are
// one.
std::optional<bool> fronts_look_inwards(std::span<const SurfaceFace> faces);

}  // namespace photorque
