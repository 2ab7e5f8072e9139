// Torques without a law: smooth functions of the motion with free coefficients, each a disturbance
// of the kind empirical_torque. They compete with the catalogue, so that an effect outside it is
// not mistaken for one inside.
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
  double scale = 1.0;       // size to be expected of a coefficient
  // Of an exponent or a time constant, which is fitted too: where a fit may start, its bounds, and
  // the width of its prior. Empty: the law has none.
  std::vector<double> starts = {};
  double lowest = 0.0, highest = 0.0, own_scale = 0.0;
};

// Ranges of the motion in the recordings, by which the laws are scaled.
struct CoveredMotion {
  double duration_s = 0.0;
  double tilt_rad = 0.0;      // the largest
  double rate_rad_s = 0.0;    // the largest; 0: no rates were recorded
  double charge_C = 0.0;      // 0: no current was recorded
  bool has_commands = false;  // of torques
  bool has_forces = false;    // that are commanded
  bool has_wheel = false;     // the speed of one was recorded
  // Of lamps, the largest in all recordings, and whether it changes within one.
  double led_current_A = 0.0;
  bool has_lamps = false;
};

// The laws that compete on such recordings. `torque_N_m` is a typical torque.
std::vector<EmpiricalLaw> empirical_laws(const CoveredMotion& covered, double torque_N_m);

}  // namespace photorque
