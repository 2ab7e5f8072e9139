// Ways to bring power aboard, side by side.
#pragma once

#include <string>

#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

// Reads [supply_trade], [platform] and [environment]. Battery, cable and induction have defaults
// for everything and are compared always, microwaves and beams of light where a table names them.
RunResult run_supply(const RunOptions& options, const Console& console);

// Reads and computes the same but for the light, which is not traced; what would be compared, in
// words.
std::string supply_in_words(const RunOptions& options);

}  // namespace photorque
