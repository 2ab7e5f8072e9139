// How much of the Sun is seen past a sphere.
#pragma once

#include "core/transform.h"

namespace photorque {

// Fraction of a luminous disc that is not covered by an opaque one, in [0, 1]: angular radii of
// both and the angle between their centres [rad]. The discs are flat: for sources of a few degrees
// and more the true solid angles differ by per cents.
double uncovered_fraction(double source_radius_rad, double cover_radius_rad, double separation_rad);

// Fraction of the Sun that a satellite sees past a planet of radius `planet_radius_m` at the
// origin: 1 in full light, 0 in the umbra. Positions in one frame, from the planet's centre [m];
// the satellite outside the planet.
double sunlit_fraction(const Vec3& satellite_m, const Vec3& sun_m, double planet_radius_m,
                       double sun_radius_m = 6.957e8);

}  // namespace photorque
