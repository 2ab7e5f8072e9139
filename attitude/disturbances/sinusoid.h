// A sinusoid of time with parameters, shared by the periodic disturbances.
#pragma once

#include "attitude/model/disturbance.h"
#include "core/constants.h"

namespace photorque {

// One standard deviation of an angle that may be anything.
constexpr double phase_scale = 1.8;

// sin(2π f t + φ).
template <class T>
T sinusoid(const T& time_s, const T& frequency_Hz, const T& phase_rad) {
  return sin(2.0 * pi * frequency_Hz * time_s + phase_rad);
}

// `phase` in radians, or phase_deg; 0 when neither is given.
inline PlacedParameters phase_parameter(const Settings& settings, ScalarKey phase) {
  return settings.has(phase.name)
             ? scalar_parameter(settings, phase)
             : scalar_parameter_or(settings, ScalarKey{"phase_rad", phase.first}, 0.0);
}

}  // namespace photorque
