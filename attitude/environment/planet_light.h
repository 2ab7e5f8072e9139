// The light that a planet sends to a satellite: sunlight that its surface reflects and its own
// infrared.
//
// Every part dA of the sphere shines by Lambert's law with the exitance
//   M = a E cos(angle of the Sun from the part's zenith, where that is above its horizon) + e E/4,
// a its albedo, e its emissivity (of the mean sunlight E/4 that the planet takes up), and brings
//   M cos α dA/(π d²)
// to a surface that looks at it; α is the angle at which it is seen from its zenith, d its
// distance.
//
// Source: P. C. Knocke, J. C. Ries, B. D. Tapley, Earth Radiation Pressure Effects on Satellites,
// AIAA/AAS Astrodynamics Conference (1988), 577–587.
#pragma once

#include <vector>

#include "core/transform.h"

namespace photorque {

// Albedo and emissivity of the surface, by latitude and season:
//   a = mean + season c P₁(sin latitude) + second P₂(sin latitude),
// c the cosine of the phase of the year since 22 December; e likewise. The numbers are the Earth's
// (Knocke, Ries, Tapley); those beside the means are 0 for a planet that is everywhere the same.
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

// A part of what the satellite sees, in axes whose z points away from the planet: its zenith, where
// it is seen from the satellite (unit vectors), and cos α dA/(π d²).
struct PlanetPart {
  Vec3 zenith, towards;
  double weight = 0.0;
};

// The visible part of a sphere from a distance of its centre > its radius, cut into `rings` of
// `sectors` each. The weights add up along z to (radius/distance)² to rounding, which is what a
// surface that looks down gets from an evenly bright planet.
std::vector<PlanetPart> planet_parts(double radius_m, double distance_m, size_t rings = 4,
                                     size_t sectors = 12);

// Axes of planet_parts() in inertial ones: z along `up`, x as near to the Sun as can be.
Mat3 planet_axes(const Vec3& up, const Vec3& to_sun);

// Irradiance from one part on a surface that faces it, of sunlight of `irradiance_W_m2`. `axes` as
// of planet_axes(); the planet turns about the inertial z axis.
struct PlanetIrradiance {
  double reflected_W_m2 = 0.0, infrared_W_m2 = 0.0;
  double sum_W_m2() const { return reflected_W_m2 + infrared_W_m2; }
};
PlanetIrradiance planet_irradiance(const PlanetPart& part, const PlanetSurface& surface,
                                   const Mat3& axes, const Vec3& to_sun, double season_cosine,
                                   double irradiance_W_m2);

}  // namespace photorque
