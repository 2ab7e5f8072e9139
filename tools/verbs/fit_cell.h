// Parameters of a solar cell, module or shaded string from measurements.
#pragma once

#include <string>

#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

// Fits the cell of [fit].
RunResult run_fit_cell(const RunOptions& options, const Console& console);

// Reads all input without fitting. Returns a description of the fit.
std::string describe_fit(const RunOptions& options);

}  // namespace photorque
