// What turns: the body on the bearing, or a spacecraft in orbit.
#pragma once

#include <optional>

#include "core/constants.h"
#include "core/settings/settings.h"
#include "core/vector.h"

namespace photorque {

enum class Topology {
  dumbbell,  // two instrumented arms, limited tilt
  tabletop,  // one plate over the bearing
  hollow,    // equipment inside the sphere
  free,      // a spacecraft: no bearing
};

struct Platform {
  Topology topology = Topology::tabletop;
  double mass_kg = 1.0;                   // > 0, of everything that turns
  Mat3 inertia_kg_m2 = Mat3::Identity();  // body axes, about the centre of rotation, symmetric
  // Angle between body z and lab z at which the bearing's stop is touched; none: no stop.
  std::optional<double> tilt_limit_rad;
  // Charge that the battery can give [C]; none: it never runs empty.
  std::optional<double> battery_capacity_C;
  double battery_voltage_V = 14.8;  // nominal, > 0
};

// Reads [platform]. InputError when the mass is not positive, the inertia not symmetric, not
// positive definite or against the triangle inequality (the largest principal moment exceeds the
// sum of the others: no body has such an inertia).
Platform read_platform(const Settings& settings);

// Throws the same complaint as read_platform() without a place in a file; `key` names the value.
void check_inertia(const Mat3& inertia_kg_m2, const InputLocation& where, const std::string& key);

}  // namespace photorque
