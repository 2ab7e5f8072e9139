#include "attitude/environment/planet_light.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/quadrature.h"

namespace photorque {

double PlanetSurface::Zones::at(double sine_of_latitude, double season_cosine) const {
  const double first = sine_of_latitude, other = 1.5 * first * first - 0.5;
  return std::clamp(mean + season * season_cosine * first + second * other, 0.0, 1.0);
}

double season_cosine(double decimal_year) {
  constexpr double december_22 = 355.0 / 365.0;
  return std::cos(2.0 * pi * (decimal_year - december_22));
}

// θ is the angle from the nadir, ρ that of the limb. The integration variable is w = √(1 −
// sin²θ/sin²ρ), in which the integrand is smooth up to the limb. Then cos θ dΩ = sin²ρ w dw dφ, and
// the distance is d = r cos θ − R w.
std::vector<PlanetPart> planet_parts(double radius_m, double distance_m, size_t rings,
                                     size_t sectors) {
  const double sine = radius_m / distance_m;  // of ρ
  std::vector<PlanetPart> parts;
  for (const QuadratureNode& node : gauss_legendre(rings)) {
    const double w = 0.5 * (1.0 + node.x), dw = 0.5 * node.weight;
    const double sin_theta = sine * std::sqrt(1.0 - w * w);
    const double cos_theta = std::sqrt(1.0 - sin_theta * sin_theta);
    const double away_m = distance_m * cos_theta - radius_m * w;
    for (size_t k = 0; k < sectors; ++k) {
      const double around =
          2.0 * pi * (static_cast<double>(k) + 0.5) / static_cast<double>(sectors);
      PlanetPart part;
      part.towards = {sin_theta * std::cos(around), sin_theta * std::sin(around), -cos_theta};
      part.zenith = (distance_m * Vec3::UnitZ() + away_m * part.towards) / radius_m;
      part.weight = 2.0 * sine * sine * w * dw / (cos_theta * static_cast<double>(sectors));
      parts.push_back(part);
    }
  }
  return parts;
}

Mat3 planet_axes(const Vec3& up, const Vec3& to_sun) {
  Vec3 x = to_sun - to_sun.dot(up) * up;
  if (!(x.norm() > 1e-9)) x = up.unitOrthogonal();
  x.normalize();
  Mat3 axes;
  axes << x, up.cross(x), up;
  return axes;
}

PlanetIrradiance planet_irradiance(const PlanetPart& part, const PlanetSurface& surface,
                                   const Mat3& axes, const Vec3& to_sun, double season_cosine,
                                   double irradiance_W_m2) {
  const Vec3 zenith = axes * part.zenith;
  const double sunlight = std::max(0.0, zenith.dot(to_sun));
  const double light_W_m2 = part.weight * irradiance_W_m2;
  return {light_W_m2 * sunlight * surface.albedo.at(zenith.z(), season_cosine),
          light_W_m2 * 0.25 * surface.emissivity.at(zenith.z(), season_cosine)};
}

}  // namespace photorque
