// The pressure of light on the platform in a run that knows the light: T = Σ of the groups of
// lamps, output of the group · torque at full output, as a table over attitude has it; or as it was
// traced beside the motion.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "attitude/model/disturbance.h"
#include "core/numerics/table.h"

namespace photorque {

// Lamps that shine alike over time.
struct LampGroup {
  size_t first_channel = 0;  // of the torque in the table: x, y, z [N m], body axes
  // Light over that at full output, ≥ 0; smooth but at the switches, where the value after it
  // counts.
  std::function<double(double time_s)> output;
  std::vector<double> switches_s;  // rising
  bool in_orbit = false;           // the Sun: the planet's shadow takes it away
};

// Both are disturbances of the kind radiation_pressure.
Disturbance light_from_table(const std::shared_ptr<const RotationTable>& table,
                             std::vector<LampGroup> groups);
// The light of ZeroOrderHold::light_body; the switches are those of `groups`.
Disturbance light_from_tracer(std::vector<LampGroup> groups);

}  // namespace photorque
