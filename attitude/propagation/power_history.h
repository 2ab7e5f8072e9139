// History of battery and solar array in a run with a simulated power system.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/snapshot.h"

namespace photorque {

struct PowerState {
  double battery_current_A = 0.0;
  double array_power_W = 0.0;
  double charge_drawn_C = 0.0;
};

class PowerHistory {
 public:
  PowerHistory(double start_s, double start_charge_C)
      : start_charge_C_(start_charge_C), known_until_s_(start_s) {}

  // Adds states in order of time. `power` holds since the previous time; its charge is that at
  // `time_s`.
  void add(double time_s, const PowerState& power) {
    time_s_.push_back(time_s);
    power_.push_back(power);
  }
  void set_known_until(double time_s) { known_until_s_ = time_s; }

  double known_until_s() const { return known_until_s_; }
  // The last state added. There must be one.
  const PowerState& last() const { return power_.back(); }
  // State at a time up to known_until_s(). Without a power system, current and power are zero and
  // the charge is constant.
  PowerState at(double time_s) const {
    if (power_.empty()) return {.charge_drawn_C = start_charge_C_};
    const auto after = std::ranges::lower_bound(time_s_, time_s);
    const auto found = static_cast<size_t>(after - time_s_.begin());
    const size_t i = std::min(found, power_.size() - 1);
    PowerState power = power_[i];
    if (i == 0) return power;
    const double part = (time_s - time_s_[i - 1]) / (time_s_[i] - time_s_[i - 1]);
    power.charge_drawn_C =
        std::lerp(power_[i - 1].charge_drawn_C, power.charge_drawn_C, std::clamp(part, 0.0, 1.0));
    return power;
  }

  void keep(Snapshot& snapshot) {
    snapshot(known_until_s_, time_s_);
    power_.resize(time_s_.size());
    snapshot.fixed(power_);
  }

 private:
  double start_charge_C_;
  double known_until_s_;
  std::vector<double> time_s_;
  std::vector<PowerState> power_;
};

}  // namespace photorque
