// A run in real time, or in lockstep with a client.
#pragma once

#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

// Propagates the experiment tick by tick with whoever connects ([serve]); says on the console where
// it listens before it waits. The result holds what `propagate` gives, `commands.csv` and, of a
// paced run, the statistics of its deadlines.
RunResult serve_experiment(const RunOptions& options, const Console& console);

}  // namespace photorque
