// The light that a planet sends to a satellite: sunlight that its surface reflects and its own
// infrared.
//
// Every element dA of the sphere emits by Lambert's law with the exitance
//   M = a E max(0, cos(zenith angle of the Sun)) + e E/4,
// with the albedo a and the emissivity e (E/4 is the mean sunlight on the planet). Its irradiance
// on a surface that faces it is
//   M cos α dA/(π d²),
// with the emission angle α and the distance d.
//
// Source: P. C. Knocke, J. C. Ries, B. D. Tapley, Earth Radiation Pressure Effects on Satellites,
// AIAA/AAS Astrodynamics Conference (1988), 577–587.
#pragma once

#include <vector>

#include "core/transform.h"

namespace photorque {

// Albedo and emissivity of the surface, by latitude and season:
//   a = mean + season c P₁(sin latitude) + second P₂(sin latitude),
// with the cosine c of the phase of the year since 22 December; e likewise. The numbers are those
// of the Earth (Knocke, Ries, Tapley). For a uniform planet, `season` and `second` are 0.
struct PlanetSurface {
  struct Zones {
    double mean = 0.0, season = 0.0, second = 0.0;
    double at(double sine_of_latitude, double season_cosine) const;
  };
  Zones albedo{0.34, 0.10, 0.29};
  Zones emissivity{0.68, -0.07, -0.18};
};

// The cosine of the phase of the year since 22 December.
double season_cosine(double decimal_year);

// An element of the visible surface, in axes whose z points away from the planet: its zenith, its
// direction from the satellite (unit vectors), and cos α dA/(π d²).
struct PlanetPart {
  Vec3 zenith, towards;
  double weight = 0.0;
};

// The elements of the visible part of a sphere: `rings` with `sectors` each. The distance from the
// centre must exceed the radius. The weights along z sum to (radius/distance)² to rounding errors,
// the irradiance of a uniform planet on a surface that faces down.
std::vector<PlanetPart> planet_parts(double radius_m, double distance_m, size_t rings = 4,
                                     size_t sectors = 12);

// Axes of planet_parts() in inertial axes: z along `up`, x as close to the Sun as possible.
Mat3 planet_axes(const Vec3& up, const Vec3& to_sun);

// Irradiance from one element on a surface that faces it, in sunlight of `irradiance_W_m2`. `axes`
// are those of planet_axes(); the planet rotates about the inertial z axis.
struct PlanetIrradiance {
  double reflected_W_m2 = 0.0, infrared_W_m2 = 0.0;
  double sum_W_m2() const { return reflected_W_m2 + infrared_W_m2; }
};
PlanetIrradiance planet_irradiance(const PlanetPart& part, const PlanetSurface& surface,
                                   const Mat3& axes, const Vec3& to_sun, double season_cosine,
                                   double irradiance_W_m2);

}  // namespace photorque
