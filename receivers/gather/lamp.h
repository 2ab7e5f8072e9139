// A beam in the body frame, and the momentum that its light transfers at first contact. For the
// files of this folder and below only.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "raytrace/direct/disc_light.h"
#include "raytrace/scene.h"
#include "raytrace/surfaces/bsdf.h"
#include "raytrace/tracing/shadow.h"

namespace photorque {

// Momentum that light of one spectrum transfers to one side of a surface at first contact.
//
// The surface takes up the arriving momentum minus the momentum of reflected and transmitted light
// (Lambert's law leaves 2/3 of E/c along the normal). With the irradiance E and the momentum flow V
// of raytrace/direct/disc_light.h, the force f per area of a plain surface is
//
//   c f = (1 − t) V − s (V − 2 (n·V) n) − ⅔ d E n,
//
// where s, d, t are the fractions mirrored, scattered and transmitted. Other surfaces are evaluated
// ray by ray.
class FirstContact {
 public:
  // `fraction` of the light per band sums to 1. The surface must outlive this object.
  FirstContact(const OpticalSurface& surface, bool front, const BandValues& fraction, int bands);

  // Whether the fractions are equal at every angle, with mirror and Lambert's law as components.
  bool plain() const { return surface_.bsdf == nullptr; }

  // c times the force per area on a plain surface with this normal on the lit side.
  Vec3 of_flow(const ArrivingLight& light, const Vec3& normal) const {
    const Vec3& in = light.momentum_W_m2;
    return (1.0 - transmitted_) * in - specular_ * (in - 2.0 * normal.dot(in) * normal) -
           lambertian_mean * diffuse_ * light.irradiance_W_m2 * normal;
  }
  // c times the force per power of a ray that travels along `direction`, for any surface.
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

// Light of each beam; beams with equal light share one object and its tables.
std::vector<std::shared_ptr<const DiscLight>> lights_of(std::span<const Beam> beams);

// A beam in the body frame: the region that its light can reach.
class PlacedLamp {
 public:
  // `light` belongs to the beam's emitter; `scene_diameter_m` see shadow.h.
  PlacedLamp(const Beam& beam, std::shared_ptr<const DiscLight> light,
             const RigidTransform& body_from_lab, const Bands& bands, double scene_diameter_m);

  const DiscLight& light() const { return *light_; }
  const RigidTransform& body_from_emitter() const { return body_from_emitter_; }
  const RigidTransform& emitter_from_body() const { return emitter_from_body_; }
  const BandValues& fraction() const { return fraction_; }  // fraction of its power per band

  // Whether no ray of the beam reaches the ball.
  bool misses(const Ball& ball) const;
  // Ball that contains every point of the aperture from which light can reach the ball.
  Ball aperture_ball(const Ball& ball) const;
  // Whether the unshaded irradiance has no kink or jump on the ball.
  bool smooth_over(const Ball& ball) const;
  // Length over which the unshaded irradiance falls by half or more, at the distance of the ball
  // [m].
  double scale_m(const Ball& ball) const;
  // Order of magnitude of the irradiance on the lit part of a plane near the ball.
  double typical_W_m2(const Ball& ball) const;

  // Points, directions and normals below are in the emitter's frame.

  // Whether rays to points at this height are sampled by direction: for apertures that are wide
  // compared with the spread of the beam. Other rays are sampled by the aperture's point.
  bool sampled_by_direction(double height_m) const;
  // Irradiance that ray i of the emitter represents at a point: by its direction (`directed`), or
  // by the point of the aperture from which it starts. Sets `from_m` to the start of the line to
  // `at_m`. 0 if no light arrives from there.
  double sampled_W_m2(const RayBlock& rays, size_t i, bool directed, const Vec3& at_m,
                      const Vec3& normal, Vec3& from_m) const;

 private:
  double along_direction_W_m2(const Vec3& direction, const Vec3& at_m, const Vec3& normal,
                              Vec3& from_m) const;
  double from_point_W_m2(const Vec3& from_m, const Vec3& at_m, const Vec3& normal) const;

  std::shared_ptr<const DiscLight> light_;
  RigidTransform body_from_emitter_, emitter_from_body_;
  BandValues fraction_{};
  double scene_diameter_m_ = 0.0;
  double reach_slope_ = 0.0;  // tangent of the light's reach
  bool wide_ = false;  // the light extends almost to the side, so that reach_slope_ is not usable
};

}  // namespace photorque
