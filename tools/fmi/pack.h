// `fmu`: an experiment as a co-simulation unit of FMI 2.0 or 3.0.
#pragma once

#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

enum class FmiVersion { two, three };

// Writes NAME.fmu: modelDescription.xml, the library, the experiment with its overrides, every file
// that it names, and the table of its light. Before it is packed, the unit is loaded and makes one
// step, which also computes this table. Throws InputError if the experiment cannot run or a file is
// missing.
RunResult pack_unit(const RunOptions& options, const Console& console, FmiVersion version);

}  // namespace photorque
