// Empirical torques: smooth functions of the motion with free coefficients, as disturbances of the
// kind empirical_torque. They compete with the catalogue, so that an effect outside the catalogue
// is not attributed to one inside.
#pragma once

#include <string>
#include <vector>

#include "attitude/disturbances/unknown/shape.h"

namespace photorque {

struct EmpiricalLaw {
  std::string variable;     // "yaw", "tilt", "rate", "time", "charge", "command"
  std::string description;  // "3 periods a turn"
  EmpiricalShape shape;
  Disturbance disturbance;  // all coefficients 0; linear in them
  double scale = 1.0;       // expected size of a coefficient
  // Exponent or time constant that is fitted too: its starts, bounds and prior width. Empty: none.
  std::vector<double> starts = {};
  double lowest = 0.0, highest = 0.0, own_scale = 0.0;
};

// Ranges of the recorded motion, which scale the laws.
struct CoveredMotion {
  double duration_s = 0.0;
  double tilt_rad = 0.0;      // maximum
  double rate_rad_s = 0.0;    // maximum; 0: no rates are recorded
  double charge_C = 0.0;      // 0: no current is recorded
  bool has_commands = false;  // commanded torques
  bool has_forces = false;    // commanded forces
  bool has_wheel = false;     // recorded wheel speed
  // Lamp current: the maximum of all recordings, and whether it changes within one.
  double led_current_A = 0.0;
  bool has_lamps = false;
};

// The laws that compete for such recordings. `torque_N_m` is a typical torque.
std::vector<EmpiricalLaw> empirical_laws(const CoveredMotion& covered, double torque_N_m);

}  // namespace photorque
