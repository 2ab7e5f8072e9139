// The trade of an experiment.
#pragma once

#include "tools/runs/options.h"
#include "tools/runs/result.h"
#include "tools/supply/report.h"

namespace photorque {

struct SupplyRun {
  SupplyTrade trade;
  RunResult result;
};

// Reads [supply_trade]: load_W (25), duration_s (86400), tilt_max_deg (the platform's stop, else
// 30), tilts (7, evenly from 0), and the ways (options.h); [platform] and [environment]. Battery,
// cable and induction have defaults for everything and are compared always, microwaves and beams of
// light where a table names them.
SupplyRun supply_of_experiment(const RunOptions& options, const Console& console);

// Reads and computes the same but for the light, which is not traced; what would be compared, in
// words.
std::string supply_in_words(const RunOptions& options);

}  // namespace photorque
