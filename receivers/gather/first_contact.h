// The momentum that light leaves with a surface where it first meets it. For the files of this
// folder only.
//
// Light brings the momentum of its directions and takes away that of what is reflected and passed
// on (Lambert's law leaves 2/3 of E/c along the normal): with the irradiance E and the flow of
// momentum V of raytrace/direct/disc_light.h, a plain surface takes up
//
//   c f = (1 − t) V − s (V − 2 (n·V) n) − ⅔ d E n,
//
// s, d, t being the fractions mirrored, scattered and passed on. Others are asked ray by ray.
#pragma once

#include "raytrace/direct/disc_light.h"
#include "raytrace/surfaces/bsdf.h"

namespace photorque {

// One side of a surface in light of one spectrum.
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

}  // namespace photorque
