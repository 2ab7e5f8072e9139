// A trace, and the solar array's power from it.
#pragma once

#include <memory>

#include "tools/runs/array_power.h"
#include "tools/runs/optical_run.h"

namespace photorque {

struct PowerRun {
  std::shared_ptr<const OpticalRun> run;
  OpticalResult light;
  ArrayPower array;
  ArrayResult power;
  RunResult result;
};

// Traces the experiment and evaluates its array. Throws InputError for invalid input.
PowerRun run_power(const RunOptions& options, const Console& console);

}  // namespace photorque
