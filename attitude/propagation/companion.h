// A simulation that runs beside the motion with steps of its own: light, and what it does to the
// battery.
#pragma once

#include <functional>

#include "attitude/propagation/propagator.h"

namespace photorque {

// What the battery and the array do at an instant.
struct CompanionPower {
  double battery_current_A = 0.0;
  double array_power_W = 0.0;
  double charge_drawn_C = 0.0;
};

struct Companion {
  // Called once before the first step and then after every step of the motion. May look at the step
  // (Propagator::dense()) and, at the end of one, exchange by Propagator::stop_at() and drive().
  std::function<void(Propagator& motion)> follow;
  // Up to known_until_s().
  std::function<CompanionPower(double time_s)> at;
  std::function<double()> known_until_s;
  // Its own state, of a companion that can be gone on with.
  std::function<void(Snapshot& snapshot)> keep = {};
};

}  // namespace photorque
