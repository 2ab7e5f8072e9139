// Physical constants, each with its source, and factors of units, all in SI.
#pragma once

#include <numbers>

namespace photorque {

inline constexpr double pi = std::numbers::pi;

// Exact by definition of the SI (BIPM, The International System of Units, 9th ed., 2019).
inline constexpr double speed_of_light_m_s = 299792458.0;
inline constexpr double planck_J_s = 6.62607015e-34;
inline constexpr double boltzmann_J_K = 1.380649e-23;
inline constexpr double elementary_charge_C = 1.602176634e-19;
inline constexpr double avogadro_1_mol = 6.02214076e23;
inline constexpr double faraday_C_mol = elementary_charge_C * avogadro_1_mol;

// Standard acceleration of gravity (3rd CGPM, 1901).
inline constexpr double standard_gravity_m_s2 = 9.80665;
// Astronomical unit (IAU 2012 Resolution B2).
inline constexpr double astronomical_unit_m = 149597870700.0;
// Nominal total solar irradiance at 1 au and solar effective temperature (IAU 2015 Resolution B3).
inline constexpr double solar_irradiance_W_m2 = 1361.0;
inline constexpr double solar_temperature_K = 5772.0;
// Angular radius of the Sun at 1 au: nominal solar radius 6.957e8 m (IAU 2015 B3) over 1 au.
inline constexpr double solar_angular_radius_rad = 6.957e8 / astronomical_unit_m;

// Maximum distance of a vertex of a model, an opening of a lamp or the start of a ray from its
// origin. Single precision can square and add such lengths, and no structure is larger.
inline constexpr double largest_extent_m = 1e9;
// Maximum distance of a lamp from the platform, 6.7 au.
inline constexpr double largest_distance_m = 1e12;

inline constexpr double degree_rad = pi / 180.0;
inline constexpr double arcsecond_rad = degree_rad / 3600.0;

// Annealed copper at 20 °C: density (ASM Handbook vol. 2), resistivity (International Annealed
// Copper Standard, IEC 60028).
inline constexpr double copper_density_kg_m3 = 8960.0;
inline constexpr double copper_resistivity_ohm_m = 1.7241e-8;

// The Earth's ellipsoid WGS 84.
inline constexpr double earth_equatorial_radius_m = 6378137.0;
inline constexpr double earth_flattening = 1.0 / 298.257223563;
// Reference radius of the geomagnetic field model IGRF. Altitudes of orbits count from it.
inline constexpr double reference_radius_of_earth_m = 6371.2e3;

}  // namespace photorque
