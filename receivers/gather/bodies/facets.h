// Triangles of a body with the data that direct light needs.
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

// The ball about the centroid that contains the triangle.
Ball ball_around(const TriangleCorners& corners_m);

// A triangle of positive area in the body frame.
struct Facet {
  TriangleCorners corner_m;
  Vec3 normal;  // of the front
  double area_m2 = 0.0;
  Ball ball;  // ball_around() the corners
  uint32_t instance = 0;
  uint32_t triangle = 0;
  // Whether no part of the scene lies above the back [0] or the front [1], so that nothing can
  // shade this side.
  std::array<bool, 2> free = {false, false};

  // The point with these weights of the corners 1 and 2.
  Vec3 at(const Vec2& uv) const {
    return corner_m[0] + uv[0] * (corner_m[1] - corner_m[0]) + uv[1] * (corner_m[2] - corner_m[0]);
  }
};

// One side of a facet.
struct FacetSide {
  const Facet* facet;
  bool front;

  Vec3 normal() const { return front ? facet->normal : Vec3(-facet->normal); }
  // Whether nothing can shade this side.
  bool is_free() const { return facet->free[front ? 1 : 0]; }
};

// All facets of a scene, instance by instance.
class Facets {
 public:
  explicit Facets(const Scene& scene);

  // Facets of an instance.
  std::span<const Facet> of(uint32_t instance) const {
    return std::span(facets_).subspan(first_[instance], first_[instance + 1] - first_[instance]);
  }
  std::span<const Facet> all() const { return facets_; }
  uint32_t instances() const { return static_cast<uint32_t>(balls_.size()); }
  // Index in all() of each triangle of each instance. A triangle without area has the index of a
  // neighbour.
  const std::vector<std::vector<uint32_t>>& numbers() const { return numbers_; }
  // Ball that contains an instance.
  const Ball& ball_of(uint32_t instance) const { return balls_[instance]; }
  size_t count() const { return facets_.size(); }
  // Index in all() of one of its elements.
  size_t number_of(const Facet& facet) const { return static_cast<size_t>(&facet - &facets_[0]); }
  // Side 2 · facet + front.
  FacetSide side(size_t number) const { return {&facets_[number / 2], number % 2 == 1}; }
  double area_m2() const;
  // Result of fronts_look_inwards() for an instance.
  std::optional<bool> inward(uint32_t instance) const { return inward_[instance]; }

 private:
  void find_free(double scene_radius_m);

  std::vector<Facet> facets_;
  std::vector<size_t> first_;
  std::vector<std::vector<uint32_t>> numbers_;
  std::vector<Ball> balls_;
  std::vector<std::optional<bool>> inward_;
};

// Sides of a mesh that light from outside cannot reach.

// Whether the front sides of a closed mesh face inwards. Empty if the inner side is undefined: an
// edge does not belong to exactly two triangles with consistent orientation, some of several bodies
// are inside out, or the volume is zero. Corners at the same position count as one.
std::optional<bool> fronts_look_inwards(std::span<const SurfaceFace> faces);

}  // namespace photorque
