// A beam as it stands over the body. For the files of this folder and below only.
#pragma once

#include <memory>

#include "raytrace/direct/disc_light.h"
#include "raytrace/scene.h"
#include "raytrace/tracing/shadow.h"

namespace photorque {

// Where the light of a beam can come from and get to.
class PlacedLamp {
 public:
  // `light` is of the beam's emitter; `scene_diameter_m` as of shadow.h.
  PlacedLamp(const Beam& beam, std::shared_ptr<const DiscLight> light,
             const RigidTransform& body_from_lab, const Bands& bands, double scene_diameter_m);

  const DiscLight& light() const { return *light_; }
  const RigidTransform& body_from_emitter() const { return body_from_emitter_; }
  const RigidTransform& emitter_from_body() const { return emitter_from_body_; }
  const BandValues& fraction() const { return fraction_; }  // of its power per band

  // No ray of the beam comes to the ball.
  bool misses(const Ball& ball) const;
  // Holds every point of the aperture from which light can come to the ball.
  Ball aperture_ball(const Ball& ball) const;
  // The unshaded irradiance has no kink or jump on the ball.
  bool smooth_over(const Ball& ball) const;
  // Length over which the unshaded irradiance falls by half or more, at the distance of the ball
  // [m].
  double scale_m(const Ball& ball) const;
  // The order of magnitude of the irradiance of the lit part of a plane near the ball.
  double typical_W_m2(const Ball& ball) const;

  // Points, directions and normals of the emitter's frame from here on.

  // How lines to places at this height are best sampled: by direction where the aperture is wide
  // against the beam, by the aperture's point elsewhere.
  bool sampled_by_direction(double height_m) const;
  // The irradiance that rays of this direction stand for, for an emitter that draws directions by
  // its intensity, and where the line to `at_m` begins; 0 where none comes so.
  double along_direction_W_m2(const Vec3& direction, const Vec3& at_m, const Vec3& normal,
                              Vec3& from_m) const;
  // The same for a point of the aperture that was drawn evenly.
  double from_point_W_m2(const Vec3& from_m, const Vec3& at_m, const Vec3& normal) const;

 private:
  std::shared_ptr<const DiscLight> light_;
  RigidTransform body_from_emitter_, emitter_from_body_;
  BandValues fraction_{};
  double scene_diameter_m_ = 0.0;
  double reach_slope_ = 0.0;  // tangent of the light's reach
  bool wide_ = false;         // the light reaches almost to the side: no slope serves
};

}  // namespace photorque
