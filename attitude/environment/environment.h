// The surroundings of the platform, constant in time. Disturbances may change them in
// EvaluationContext.
#pragma once

#include <optional>

#include "attitude/environment/sun.h"
#include "core/constants.h"
#include "core/settings/typed_keys.h"
#include "core/transform.h"

namespace photorque {

// Mean radius of the Earth (IUGG R1) and its rate of rotation (IERS Conventions 2010, table 1.1).
inline constexpr double earth_radius_m = 6371008.7714;
inline constexpr double earth_rate_rad_s = 7.292115e-5;

inline constexpr double room_temperature_K = 293.15, room_pressure_Pa = 101325.0;

struct Environment {
  // Lab axes: x east, y north, z up (inertial axes for a spacecraft).
  Vec3 gravity_lab_m_s2{0.0, 0.0, -standard_gravity_m_s2};
  Vec3 magnetic_field_lab_T = Vec3::Zero();
  double latitude_rad = 0.0;
  // Unit vector away from the Earth's centre, and g/R (μ/r³ in orbit): see gravity_gradient.
  Vec3 up_lab = Vec3::UnitZ();
  double gravity_gradient_1_s2 = standard_gravity_m_s2 / earth_radius_m;
  // Rate of the Earth's rotation in lab axes; zero if the lab is the inertial frame.
  Vec3 earth_rate_lab_rad_s = Vec3::Zero();
  // Direction and distance of the Sun; empty: not stated.
  std::optional<SunPath> sun = {};

  double air_temperature_K = room_temperature_K;
  double air_pressure_Pa = room_pressure_Pa;
  // Default: dry air at this temperature and pressure, from the ideal gas law with R = 287.05 J/(kg
  // K) and Sutherland's law with 1.716e-5 Pa s at 273.15 K and S = 110.4 K (White, Viscous Fluid
  // Flow, 3rd ed., table 1-2).
  double air_density_kg_m3 = 1.2041;
  double air_viscosity_Pa_s = 1.813e-5;
};

// Reads [environment], whose keys, all with defaults, are environment_table().
Environment read_environment(const Settings& settings);
Key environment_table();

}  // namespace photorque
