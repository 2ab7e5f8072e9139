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

// If the experiment enables them, the rays that arrive on each flux map are files of the result;
// without `with_files` they are not traced.
TraceRun run_trace(const RunOptions& options, const Console& console, bool with_files = true);

}  // namespace photorque
