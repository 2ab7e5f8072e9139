// Sunlight and a textbook's law of its pressure, for tests of receivers.
#pragma once

#include "core/constants.h"
#include "tests/receivers/gather_lamps.h"

namespace photorque::fixtures {

inline constexpr double irradiance_W_m2 = 1361.0;
inline constexpr double pressure_Pa = irradiance_W_m2 / speed_of_light_m_s;

inline Beam sun(double angular_radius_deg) {
  return source("sun", {{"irradiance_W_m2", {irradiance_W_m2}},
                        {"angular_radius_deg", {angular_radius_deg}}});
}

// F = P A cos θ [(1 − ρs) d − 2 (ρs cos θ + ρd/3) n] on a flat plate whose normal n looks against
// the light's travel d.
// Source: J. R. Wertz (ed.), Spacecraft Attitude Determination and Control (1978), eq. 17-37.
inline Vec3 textbook_N(double area_m2, double specular, double diffuse, const Vec3& travel,
                       const Vec3& normal) {
  const double cosine = -travel.dot(normal);
  return pressure_Pa * area_m2 * cosine *
         ((1.0 - specular) * travel - 2.0 * (specular * cosine + diffuse / 3.0) * normal);
}

}  // namespace photorque::fixtures
