// Laws that act in injected cases but stand in no catalogue: `diagnose` must say that something
// unknown acts.
//   heading_cogging (torque_N_m, periods, phase): about the vertical, n periods a turn of heading;
//   tilt_cubed (coefficient_N_m): pulls back with the cube of the tilt;
//   slow_random_torque (torque_N_m[3] rms about lab axes, time_s correlation, seed);
//   exponential_decay (torque_N_m[3] body, time_s);
//   pulsed_torque (torque_N_m[3] body, period_s): on for the first third of each period.
#pragma once

#include <string>
#include <vector>

#include "attitude/injection/injection.h"

namespace photorque::injected {

struct OutsideLaw {
  std::string name;
  std::string depends_on;  // what an empirical law would have to follow
  Injection injection;
};

std::vector<OutsideLaw> outside_laws();

}  // namespace photorque::injected
