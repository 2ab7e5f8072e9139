// What is commanded when: values that hold from their time to the next (zero-order hold).
#pragma once

#include <vector>

#include "core/vector.h"

namespace photorque {

struct ZeroOrderHold {
  Vec3 command_body_N_m = Vec3::Zero();
  double battery_current_A = 0.0;  // positive discharges

  bool operator==(const ZeroOrderHold&) const = default;
};

// Before the first time everything is zero. `time_s` rises strictly; `held` has the same length.
struct Schedule {
  std::vector<double> time_s;
  std::vector<ZeroOrderHold> held;
  // The battery's current is what was measured, all of it: no law of the model adds to it.
  bool current_is_measured = false;

  ZeroOrderHold at(double t_s) const;
  // Appends unless the values are those that hold already. NumericalError unless `t_s` is later
  // than all before.
  void append(double t_s, const ZeroOrderHold& values);
};

}  // namespace photorque
