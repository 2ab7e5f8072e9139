#include "raytrace/surfaces/bsdf.h"

#include <cmath>

#include "core/constants.h"

namespace photorque {

PowerFractions fractions_of(const OpticalSurface& surface, double cosine, size_t band) {
  const Bsdf* bsdf = surface.bsdf.get();
  if (bsdf != nullptr && bsdf->law) return bsdf->law->fractions(cosine, band);
  return {surface.absorbed[band], surface.specular[band], surface.diffuse[band],
          surface.transmitted[band], bsdf == nullptr ? 0.0 : bsdf->retroreflected[band]};
}

double scattering_1_sr(const OpticalSurface& surface, double cosine, const Vec3& out, size_t band) {
  const PowerFractions fractions = fractions_of(surface, cosine, band);
  const Bsdf* bsdf = surface.bsdf.get();
  double f = 0.0;
  if (bsdf != nullptr && bsdf->specular) {
    f += fractions.specular * bsdf->specular->density(cosine, out) / out.z();
  }
  f +=
      fractions.diffuse *
      (bsdf != nullptr && bsdf->diffuse ? bsdf->diffuse->density(cosine, out) / out.z() : 1.0 / pi);
  return f;
}

Vec3 first_moment(const OpticalSurface& surface, double cosine, size_t band) {
  const PowerFractions fractions = fractions_of(surface, cosine, band);
  const Bsdf* bsdf = surface.bsdf.get();
  const Vec3 towards_light(std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), 0.0, cosine);
  const Vec3 mirrored(-towards_light.x(), 0.0, cosine);
  Vec3 mean = (fractions.retroreflected - fractions.transmitted) * towards_light;
  mean += fractions.specular *
          (bsdf != nullptr && bsdf->specular ? bsdf->specular->mean_direction(cosine) : mirrored);
  mean +=
      fractions.diffuse * (bsdf != nullptr && bsdf->diffuse ? bsdf->diffuse->mean_direction(cosine)
                                                            : Vec3(0.0, 0.0, 2.0 / 3.0));
  return mean;
}

Vec3 lambertian_direction(double u, double v) {
  const double radius = std::sqrt(u), angle = 2.0 * pi * v;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1.0 - u)};
}

}  // namespace photorque
