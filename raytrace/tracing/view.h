// The first surfaces seen from a point along given rays, without light; and rays for drawings.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "raytrace/emitter.h"
#include "raytrace/tracing/tracer.h"

namespace photorque {

// A line of sight in the body frame; the direction is of unit length.
struct Sight {
  Vec3 origin_m = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();
};

// The first surface along a line of sight, in the body frame.
struct VisiblePoint {
  bool hit = false;
  bool front = true;  // the front of the surface is seen
  uint32_t instance = 0;
  uint32_t triangle = 0;
  Vec2 barycentric = Vec2::Zero();  // weights of the triangle's vertices 1 and 2
  Vec3 position_m = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  // unit, towards the viewer
  double distance_m = std::numeric_limits<double>::infinity();
};

// Points seen along the lines of sight 0 … count − 1. `sight` is called from many threads.
std::vector<VisiblePoint> look(const TraceableScene& scene, size_t count,
                               const std::function<Sight(size_t)>& sight, int threads = 0);

// Whether a lamp cannot be drawn beside a scene of `radius_m` about the lab origin: it is too far
// away, or has no position (parallel light).
bool is_too_far_to_draw(const Beam& beam, double radius_m);

// About this number of rays, divided evenly between the lamps as they emit them. Result in the lab
// frame: x, y, z of each ray's start (near the scene) and of its end, where it first meets a
// surface or leaves the surroundings of the scene. Rays of far lamps that miss the scene's
// surroundings are omitted.
std::vector<float> shown_rays(const TraceableScene& scene, const std::vector<Beam>& beams,
                              const RigidTransform& lab_from_body, double radius_m, size_t about);

}  // namespace photorque
