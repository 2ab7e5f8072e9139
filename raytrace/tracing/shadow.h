// Occlusion between a flat patch of surface and an aperture. Proves that nothing is in between or
// that everything is blocked; other cases need shadow rays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "raytrace/tracing/tracer.h"

namespace photorque {

using TriangleCorners = std::array<Vec3, 3>;  // body frame [m]

// A solid sphere in the body frame.
struct Ball {
  Vec3 centre_m;
  double radius_m;
};

// Neighbouring triangles of one part of the scene.
struct Occluder {
  // The half-space of points p with normal · p ≤ offset_m.
  struct Face {
    Vec3 normal;
    double offset_m;
  };

  std::vector<TriangleCorners> triangles;
  Ball ball;  // contains the triangles
  // faces of the closed convex body that the triangles bound; empty if it is not one
  std::vector<Face> faces;
};

// Triangles of a scene that reach above a plane and can therefore shade it.
std::vector<Occluder> occluders_above(const Scene& scene, const Vec3& plane_point_m,
                                      const Vec3& plane_normal);

// The convex hull of two balls: all straight lines between them.
class Shaft {
 public:
  Shaft(const Ball& from, const Ball& to);

  // False proves that the triangle and the shaft have no common point. The test clips the triangle
  // between the planes at the ends of the shaft. It compares the distance of this part from the
  // axis with the largest radius of the shaft there.
  bool may_meet(const TriangleCorners& triangle) const;
  bool may_meet(const Occluder& occluder) const;
  // True proves that every straight line from a point of one ball to a point of the other passes
  // through the surface of the closed convex body: a disc across the shaft is inside the body, and
  // the second ball is outside it.
  bool is_blocked_by(const Occluder& occluder) const;

 private:
  bool may_meet(const Ball& ball) const;

  Vec3 start_m_, axis_, across_, aside_;
  Ball end_;
  double low_m_, high_m_;    // ends of the shaft along the axis, from start_m_
  double first_m_, last_m_;  // range between the balls along the axis; empty if last_m_ < first_m_
  // radius of the shaft: radius_m_ + widening_ · position, between its ends
  double radius_m_, widening_;
};

// A straight line between two points, or from a point out of the scene. Body axes.
struct ShadowRay {
  float origin_m[3];   // from scene_centre_m()
  float direction[3];  // unit length
  float length_m;
};

ShadowRay shadow_ray(const Vec3& origin_m, const Vec3& direction, double length_m);

// Maximum number of rays per call of find_shadows().
inline constexpr int shadow_batch = 256;

// Sets lit[i] to 1 if nothing in the scene crosses ray i, else to 0.
void find_shadows(const TraceableScene& scene, std::span<const ShadowRay> rays,
                  std::span<uint8_t> lit);
// Likewise for any number of rays.
std::vector<uint8_t> unshadowed(const TraceableScene& scene, std::span<const ShadowRay> rays);

// Ray offset of a shadow ray above its surface [m]; and a radius [m] that contains the whole scene
// as seen from any point of it.
double shadow_ray_offset_m(const TraceableScene& scene);
double scene_diameter_m(const TraceableScene& scene);
// Origin of the coordinates of shadow rays, in the body frame: the centre of the scene.
const Vec3& scene_centre_m(const TraceableScene& scene);

}  // namespace photorque
