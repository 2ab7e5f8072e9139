// The light from a planet to a satellite: reflected sunlight and thermal infrared.
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

// Albedo and emissivity of the surface by latitude and season:
//   a = mean + season c P₁(sin latitude) + second P₂(sin latitude),
// with the cosine c of the phase of the year since 22 December; the emissivity has the same form.
// The defaults are those of the Earth (Knocke, Ries, Tapley). A uniform planet has `season` and
// `second` 0.
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

// An element of the visible surface, in axes with z away from the planet: its zenith and its
// direction from the satellite (unit vectors), and cos α dA/(π d²).
struct PlanetPart {
  Vec3 zenith, towards;
  double weight = 0.0;
};

// The elements of the visible part of a sphere: `rings` with `sectors` each. The distance from the
// centre must exceed the radius. The weights along z sum to (radius/distance)² within rounding
// errors. This is the relative irradiance of a uniform planet on a surface that faces down.
std::vector<PlanetPart> planet_parts(double radius_m, double distance_m, size_t rings = 4,
                                     size_t sectors = 12);

// Axes of planet_parts() in inertial axes: z along `up`, x as close to the direction of the Sun as
// possible. Unit vectors.
Mat3 planet_axes(const Vec3& up, const Vec3& to_sun);

// Irradiance from one element on a surface that faces it, with a solar irradiance of
// `irradiance_W_m2`. `axes` are those of planet_axes(). The inertial z axis is the planet's axis of
// rotation.
struct PlanetIrradiance {
  double reflected_W_m2 = 0.0, infrared_W_m2 = 0.0;
  double sum_W_m2() const { return reflected_W_m2 + infrared_W_m2; }
};
PlanetIrradiance planet_irradiance(const PlanetPart& part, const PlanetSurface& surface,
                                   const Mat3& axes, const Vec3& to_sun, double season_cosine,
                                   double irradiance_W_m2);

}  // namespace photorque
