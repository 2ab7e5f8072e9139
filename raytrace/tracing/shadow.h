// Occlusion between a flat patch of surface and an aperture: proofs that nothing does, and shadow
// rays where something may.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "raytrace/tracing/tracer.h"

namespace photorque {

using TriangleCorners = std::array<Vec3, 3>;  // body frame [m]

// The triangles of a scene that can shade a plane: all that reach above it.
std::vector<TriangleCorners> triangles_above(const Scene& scene, const Vec3& plane_point_m,
                                             const Vec3& plane_normal);

// A sphere with its inside, in the body frame.
struct Ball {
  Vec3 centre_m;
  double radius_m;
};

// The convex hull of two balls: all straight lines between them.
class Shaft {
 public:
  Shaft(const Ball& from, const Ball& to);

  // False proves that the triangle and the shaft have no point in common: the part of the triangle
  // between the planes that end the shaft, seen along its axis, is further away from the axis than
  // the shaft is wide at its widest there.
  bool may_meet(const TriangleCorners& triangle) const;

 private:
  Vec3 start_m_, axis_, across_, aside_;
  double low_m_, high_m_;       // along the axis, from start_m_
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

// Ray offset of a shadow ray above its surface, and a radius that contains the whole scene as
// seen from any point of it.
double shadow_ray_offset_m(const TraceableScene& scene);
double scene_diameter_m(const TraceableScene& scene);
// Where shadow rays count from, in the body frame: the middle of the scene.
const Vec3& scene_centre_m(const TraceableScene& scene);

}  // namespace photorque
