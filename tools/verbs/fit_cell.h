// The parameters of a solar cell, module or shaded string from measurements.
#pragma once

#include <string>

#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

// What [fit] of the experiment asks for.
RunResult run_fit_cell(const RunOptions& options, const Console& console);

// The same without fitting: all input is read, and this is what would be done.
std::string what_fit_asks(const RunOptions& options);

}  // namespace photorque
