// The light of lamps over time: switched by a schedule, fading as they warm up.
#pragma once

#include <vector>

#include "photovoltaics/array/day.h"

namespace photorque {

// When lamps are switched on and off.
struct LampSchedule {
  bool on_at_start = true;
  std::vector<double> time_s;  // rises strictly; at each of them the state changes
};

// Light over that at full power of cold lamps. What LampDroop says of the time since a lamp was
// switched on follows from two lags of first order, which recover while the lamp is off, with the
// same time constants. At the start the lamps are cold.
class LampOutput {
 public:
  LampOutput(const LampDroop& droop, const LampSchedule& schedule, double start_s);

  // At and after start_s; at a switch the value after it.
  double at(double time_s) const;
  const std::vector<double>& switches_s() const { return switches_s_; }

 private:
  struct Stage {
    double from_s = 0.0;
    bool on = true;
    double faded = 0.0, warm = 0.0;  // at from_s, fractions of the full effects
  };
  double output(const Stage& stage, double time_s) const;

  LampDroop droop_;
  std::vector<double> switches_s_;
  std::vector<Stage> stages_;
};

}  // namespace photorque
