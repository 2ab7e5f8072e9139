// Dry air as an ideal gas. Source of the laws of Sutherland: F. M. White, Viscous Fluid Flow,
// 3rd ed., tables 1-2 and 1-3, accurate to 2 % (viscosity) and 3 % (conductivity) from 170 to 1900
// K.
#pragma once

#include <cmath>

namespace photorque {

inline constexpr double dry_air_gas_constant_J_kg_K = 287.05;

inline double dry_air_density_kg_m3(double pressure_Pa, double temperature_K) {
  return pressure_Pa / (dry_air_gas_constant_J_kg_K * temperature_K);
}

inline double dry_air_viscosity_Pa_s(double temperature_K) {
  constexpr double reference_K = 273.15, sutherland_K = 110.4;
  return 1.716e-5 * std::pow(temperature_K / reference_K, 1.5) * (reference_K + sutherland_K) /
         (temperature_K + sutherland_K);
}

inline double dry_air_conductivity_W_m_K(double temperature_K) {
  constexpr double reference_K = 273.15, sutherland_K = 194.0;
  return 0.0241 * std::pow(temperature_K / reference_K, 1.5) * (reference_K + sutherland_K) /
         (temperature_K + sutherland_K);
}

}  // namespace photorque
