#include "attitude/environment/eclipse.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

// Area of the segment that a chord at `distance` from the centre cuts from a circle.
double segment_area(double radius, double distance) {
  const double cosine = std::clamp(distance / radius, -1.0, 1.0);
  return radius * radius * (std::acos(cosine) - cosine * std::sqrt(1.0 - cosine * cosine));
}

}  // namespace

double uncovered_fraction(double source_radius_rad, double cover_radius_rad,
                          double separation_rad) {
  const double a = source_radius_rad, b = cover_radius_rad, c = separation_rad;
  if (c >= a + b) return 1.0;
  if (c <= b - a) return 0.0;
  if (c <= a - b) return 1.0 - (b / a) * (b / a);
  // The lens between the circles, cut along their common chord.
  const double to_chord = (c * c + a * a - b * b) / (2.0 * c);
  const double covered = segment_area(a, to_chord) + segment_area(b, c - to_chord);
  return 1.0 - covered / (pi * a * a);
}

double sunlit_fraction(const Vec3& satellite_m, const Vec3& sun_m, double planet_radius_m,
                       double sun_radius_m) {
  const Vec3 to_sun = sun_m - satellite_m, to_planet = -satellite_m;
  const double separation = std::atan2(to_sun.cross(to_planet).norm(), to_sun.dot(to_planet));
  return uncovered_fraction(std::asin(sun_radius_m / to_sun.norm()),
                            std::asin(std::min(1.0, planet_radius_m / to_planet.norm())),
                            separation);
}

}  // namespace photorque
