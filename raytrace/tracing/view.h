// The view from a point: the first surfaces along given rays, without light; rays to be drawn.
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

// The first surface along a sight. Body frame.
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

// The points seen along sights 0 … count − 1. `sight` is called from many threads.
std::vector<VisiblePoint> look(const TraceableScene& scene, size_t count,
                               const std::function<Sight(size_t)>& sight, int threads = 0);

// Whether a lamp is too far from a scene of `radius_m` about the lab origin to be drawn beside it,
// or has no place at all (parallel light).
bool is_too_far_to_draw(const Beam& beam, double radius_m);

// About so many rays, shared evenly by the lamps, as these emit them: lab frame, x, y, z of where
// each starts (near the scene) and of where it first meets something, or leaves the scene's
// surroundings. Of far lamps those that pass the scene are left out.
std::vector<float> shown_rays(const TraceableScene& scene, const std::vector<Beam>& beams,
                              const RigidTransform& lab_from_body, double radius_m, size_t about);

}  // namespace photorque
