#include "photovoltaics/supply/lamp_output.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

// Of a lag towards 1 (on) or 0.
double lagged(double from, bool on, double elapsed_s, double time_constant_s) {
  const double target = on ? 1.0 : 0.0;
  return target + (from - target) * std::exp(-elapsed_s / time_constant_s);
}

}  // namespace

LampOutput::LampOutput(const LampDroop& droop, const LampSchedule& schedule, double start_s)
    : droop_(droop) {
  Stage stage{start_s, schedule.on_at_start, 0.0, 0.0};
  for (const double time_s : schedule.time_s) {
    if (time_s <= start_s) {
      stage.on = !stage.on;
      continue;
    }
    stages_.push_back(stage);
    const double elapsed_s = time_s - stage.from_s;
    stage.faded = lagged(stage.faded, stage.on, elapsed_s, droop_.time_constant_s);
    stage.warm = lagged(stage.warm, stage.on, elapsed_s, droop_.rise_time_constant_s);
    stage.from_s = time_s;
    stage.on = !stage.on;
    switches_s_.push_back(time_s);
  }
  stages_.push_back(stage);
}

double LampOutput::output(const Stage& stage, double time_s) const {
  if (!stage.on) return 0.0;
  const double elapsed_s = std::max(0.0, time_s - stage.from_s);
  const double faded = lagged(stage.faded, true, elapsed_s, droop_.time_constant_s);
  const double warm = lagged(stage.warm, true, elapsed_s, droop_.rise_time_constant_s);
  return (1.0 - droop_.depth * faded) * (1.0 - droop_.roll_off_1_K * droop_.rise_K * warm);
}

double LampOutput::at(double time_s) const {
  const auto after = std::ranges::upper_bound(stages_, time_s, {}, &Stage::from_s);
  return output(after == stages_.begin() ? stages_.front() : *(after - 1), time_s);
}

}  // namespace photorque
