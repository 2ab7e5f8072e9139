// Occlusion between a flat patch of surface and an aperture: proofs that nothing is in between, or
// that something is in the way of everything, and shadow rays elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "raytrace/tracing/tracer.h"

namespace photorque {

using TriangleCorners = std::array<Vec3, 3>;  // body frame [m]

// A sphere with its inside, in the body frame.
struct Ball {
  Vec3 centre_m;
  double radius_m;
};

// Triangles of one part of the scene, near each other.
struct Occluder {
  // The half-space of points p with normal · p ≤ offset_m.
  struct Face {
    Vec3 normal;
    double offset_m;
  };

  std::vector<TriangleCorners> triangles;
  Ball ball;                // holds them
  std::vector<Face> faces;  // of a closed convex body, whose surface they are; else empty
};

// The triangles of a scene that reach above a plane, and so can shade it.
std::vector<Occluder> occluders_above(const Scene& scene, const Vec3& plane_point_m,
                                      const Vec3& plane_normal);

// The convex hull of two balls: all straight lines between them.
class Shaft {
 public:
  Shaft(const Ball& from, const Ball& to);

  // False proves that the triangle and the shaft have no point in common: the part of the triangle
  // between the planes that end the shaft, seen along its axis, is further away from the axis than
  // the shaft is wide at its widest there.
  bool may_meet(const TriangleCorners& triangle) const;
  bool may_meet(const Occluder& occluder) const;
  // True proves that every straight line from a point of one ball to a point of the other goes
  // through the surface of the closed convex body: a disc across the shaft is inside it, and the
  // second ball is outside.
  bool is_blocked_by(const Occluder& occluder) const;

 private:
  bool may_meet(const Ball& ball) const;

  Vec3 start_m_, axis_, across_, aside_;
  Ball end_;
  double low_m_, high_m_;       // along the axis, from start_m_
  double first_m_, last_m_;     // between the balls, likewise; none where last_m_ < first_m_
  double radius_m_, widening_;  // of the shaft: radius_m_ + widening_ · along, within the ends
};

// A straight line from a point to another, or until it has left the scene. Body axes.
struct ShadowRay {
  float origin_m[3];   // from scene_centre_m()
  float direction[3];  // unit length
  float length_m;
};

// Most rays of one call of find_shadows().
inline constexpr int shadow_batch = 256;

// Sets lit[i] to 1 where nothing of the scene crosses ray i, else to 0.
void find_shadows(const TraceableScene& scene, std::span<const ShadowRay> rays,
                  std::span<uint8_t> lit);
// Likewise for any number of rays.
std::vector<uint8_t> unshadowed(const TraceableScene& scene, std::span<const ShadowRay> rays);

// Ray offset of a shadow ray above its surface, and a radius that contains the whole scene as
// seen from any point of it.
double shadow_ray_offset_m(const TraceableScene& scene);
double scene_diameter_m(const TraceableScene& scene);
// Where shadow rays count from, in the body frame: the middle of the scene.
const Vec3& scene_centre_m(const TraceableScene& scene);

}  // namespace photorque
