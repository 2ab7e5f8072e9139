// Results of a run to files, and where they are to the console.
#pragma once

#include "tools/commands/verb.h"
#include "tools/runs/console.h"
#include "tools/runs/result.h"

namespace photorque {

// Writes every item of the product and summary.json into the command's folder and says where; with
// --json prints the summary.
void write_results(const CommandLine& line, const Console& console, const RunResult& result);

}  // namespace photorque
