// Laws that act in injected cases but stand in no catalogue: `diagnose` must say that something
// unknown acts.
//   heading_cogging (torque_N_m, periods, phase): about the vertical, n periods a turn of heading;
//   tilt_cubed (coefficient_N_m): pulls back with the cube of the tilt;
//   slow_random_torque (torque_N_m[3] rms about lab axes, time_s correlation, seed);
//   exponential_decay (torque_N_m[3] body, time_s);
//   pulsed_torque (torque_N_m[3] body, period_s): on for the first third of each period;
//   edge_drag (coefficient_N_m_s): against the rate in proportion to the tilt's square in
//     (0.1 rad)², the gap of the bearing opens at one side;
//   rough_pad (coefficient_N_m_s, heading_rad, width_rad): a drag about the vertical near one
//     heading, where a pad of the bearing is rough;
//   slack_cable (stiffness_N_m_per_rad, free_rad): pulls upright, but only beyond a free tilt.
#pragma once

#include <string>
#include <vector>

#include "attitude/injection/injection.h"

namespace photorque::injected {

struct OutsideLaw {
  std::string name;
  std::vector<std::string> depends_on;  // what an empirical law would have to follow: any of them
  Injection injection;
};

std::vector<OutsideLaw> outside_laws();

}  // namespace photorque::injected
