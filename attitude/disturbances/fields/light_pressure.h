// The pressure of light on the platform in a run with a simulation of the light. The torque is the
// sum over groups of lamps: the output of the group times its torque at full output, from a table
// over the attitude. Instead, it may be traced during the run.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "attitude/model/disturbance.h"
#include "core/numerics/table.h"

namespace photorque {

// Lamps with equal output as a function of time.
struct LampGroup {
  size_t first_channel = 0;  // channel of the x torque in the table, then y, z [N m], body axes
  // Light relative to that at full output, ≥ 0. It is smooth except at the switches, where it has
  // the value after the switch.
  std::function<double(double time_s)> output;
  std::vector<double> switches_s;  // times of switches, increasing
  bool in_orbit = false;           // the Sun, which the planet may eclipse
};

// Both are disturbances of the kind radiation_pressure.
Disturbance light_from_table(const std::shared_ptr<const RotationTable>& table,
                             std::vector<LampGroup> groups);
// The light of ZeroOrderHold::light_body; the switches are those of `groups`.
Disturbance light_from_tracer(std::vector<LampGroup> groups);

}  // namespace photorque
