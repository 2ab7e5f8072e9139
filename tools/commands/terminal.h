// The console of the program: standard output and a progress bar on standard error.
#pragma once

#include "tools/commands/verb.h"
#include "tools/runs/console.h"

namespace photorque {

// Text on standard output; silent with --quiet, and with --json, where only the summary appears. A
// bar where standard error is a terminal; else a line of words at most every ten seconds.
Console terminal(const CommandLine& line);

}  // namespace photorque
