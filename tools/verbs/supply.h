// Comparison of power supplies for the platform.
#pragma once

#include <string>

#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

// Reads [supply_trade], [platform] and [environment]. Battery, cable and inductive link have
// defaults for all keys and are always compared; microwaves and light beams are compared if a table
// names them.
RunResult run_supply(const RunOptions& options, const Console& console);

// Reads the same input, but traces no light. Returns a description of the comparison.
std::string supply_in_words(const RunOptions& options);

}  // namespace photorque
