#include "raytrace/surfaces/bsdf.h"

#include <cmath>

#include "core/constants.h"

namespace photorque {

Shares shares_of(const OpticalSurface& surface, double cosine, size_t band) {
  const Finish* finish = surface.finish.get();
  if (finish != nullptr && finish->law) return finish->law->shares(cosine, band);
  return {surface.absorbed[band], surface.specular[band], surface.diffuse[band],
          surface.transmitted[band], finish == nullptr ? 0.0 : finish->retroreflected[band]};
}

double scattering_1_sr(const OpticalSurface& surface, double cosine, const Vec3& out, size_t band) {
  const Shares shares = shares_of(surface, cosine, band);
  const Finish* finish = surface.finish.get();
  double f = 0.0;
  if (finish != nullptr && finish->specular) {
    f += shares.specular * finish->specular->density(cosine, out) / out.z();
  }
  f += shares.diffuse * (finish != nullptr && finish->diffuse
                             ? finish->diffuse->density(cosine, out) / out.z()
                             : 1.0 / pi);
  return f;
}

Vec3 mean_departure(const OpticalSurface& surface, double cosine, size_t band) {
  const Shares shares = shares_of(surface, cosine, band);
  const Finish* finish = surface.finish.get();
  const Vec3 towards_light(std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), 0.0, cosine);
  const Vec3 mirrored(-towards_light.x(), 0.0, cosine);
  Vec3 mean = (shares.retroreflected - shares.transmitted) * towards_light;
  mean +=
      shares.specular *
      (finish != nullptr && finish->specular ? finish->specular->mean_direction(cosine) : mirrored);
  mean += shares.diffuse * (finish != nullptr && finish->diffuse
                                ? finish->diffuse->mean_direction(cosine)
                                : Vec3(0.0, 0.0, 2.0 / 3.0));
  return mean;
}

Vec3 lambertian_direction(double u, double v) {
  const double radius = std::sqrt(u), angle = 2.0 * pi * v;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1.0 - u)};
}

}  // namespace photorque
