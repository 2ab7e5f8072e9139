// Irradiance on every receiver, power balance, radiation wrench.
#pragma once

#include <memory>

#include "tools/runs/optical_run.h"

namespace photorque {

struct TraceRun {
  std::shared_ptr<const OpticalRun> run;
  OpticalResult light;
  RunResult result;
};

// If the experiment enables them, the rays that arrive on each flux map become files of the result;
// `with_files` = false omits them.
TraceRun run_trace(const RunOptions& options, const Console& console, bool with_files = true);

}  // namespace photorque
