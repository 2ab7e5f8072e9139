// A beam as it stands over the body, and the momentum that its light leaves at first contact. For
// the files of this folder and below only.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "raytrace/direct/disc_light.h"
#include "raytrace/scene.h"
#include "raytrace/surfaces/bsdf.h"
#include "raytrace/tracing/shadow.h"

namespace photorque {

// The momentum that light of one spectrum leaves with one side of a surface where it first meets
// it.
//
// Light brings the momentum of its directions and takes away that of light reflected and passed on
// (Lambert's law leaves 2/3 of E/c along the normal): with the irradiance E and the flow of
// momentum V of raytrace/direct/disc_light.h, a plain surface takes up
//
//   c f = (1 − t) V − s (V − 2 (n·V) n) − ⅔ d E n,
//
// s, d, t being the fractions mirrored, scattered and passed on. Others are asked ray by ray.
class FirstContact {
 public:
  // `fraction` of the light per band sums to 1. The surface must outlive this.
  FirstContact(const OpticalSurface& surface, bool front, const BandValues& fraction, int bands);

  // Fractions are the same at every angle, and light goes by mirror and Lambert's law alone.
  bool plain() const { return surface_.bsdf == nullptr; }

  // c times the force per area of a plain surface with this normal on the lit side.
  Vec3 of_flow(const ArrivingLight& light, const Vec3& normal) const {
    const Vec3& in = light.momentum_W_m2;
    return (1.0 - transmitted_) * in - specular_ * (in - 2.0 * normal.dot(in) * normal) -
           lambertian_mean * diffuse_ * light.irradiance_W_m2 * normal;
  }
  // c times the force per power of a ray that travels along `direction`, on any surface.
  Vec3 of_ray(const Vec3& direction, const Vec3& normal) const {
    return plain() ? of_flow({1.0, direction}, normal) : by_law(direction, normal);
  }

 private:
  Vec3 by_law(const Vec3& direction, const Vec3& normal) const;

  const OpticalSurface& surface_;
  bool front_;
  BandValues fraction_;
  int bands_;
  double specular_ = 0.0, diffuse_ = 0.0, transmitted_ = 0.0;
};

// The light of each beam; beams that shine alike share one, and its tables.
std::vector<std::shared_ptr<const DiscLight>> lights_of(std::span<const Beam> beams);

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

  // Sampling of lines to points at this height: by direction where the aperture is wide
  // against the beam, by the aperture's point elsewhere.
  bool sampled_by_direction(double height_m) const;
  // The irradiance that rays of this direction stand for, for an emitter that draws directions by
  // its intensity, and where the line to `at_m` begins; 0 where none comes so.
  double along_direction_W_m2(const Vec3& direction, const Vec3& at_m, const Vec3& normal,
                              Vec3& from_m) const;
  // The irradiance from a point of the aperture that was drawn evenly.
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
