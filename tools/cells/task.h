// What [fit] of an experiment asks `fit-cell` for.
#pragma once

#include <filesystem>
#include <vector>

#include "core/settings/settings.h"
#include "photovoltaics/fit/fit.h"

namespace photorque {

struct FitTask {
  std::vector<std::filesystem::path> files;
  std::vector<IvSweep> sweeps;
  std::vector<RatedPoint> datasheet;
  TemperatureSlopes slopes;
  RatedTolerance tolerance;
  SweepNoise noise;
  int cells_in_series = 1;
  int substrings = 0;  // 0: even light
  double temperature_K = 298.15;

  // n V_t of the whole device over the ideality of one of its cells, at that temperature.
  double thermal_V() const;
};

// Reads the curves too, relative to `folder`. InputError for what is missing or contradicts itself,
// and for cells in series that no cell's voltage goes with.
FitTask read_fit_task(const Settings& root, const std::filesystem::path& folder);

}  // namespace photorque
