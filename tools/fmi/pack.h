// `fmu`: an experiment as a co-simulation unit of FMI 2.0 or 3.0.
#pragma once

#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

enum class FmiVersion { two, three };

// NAME.fmu: modelDescription.xml, the library, the experiment with its overrides and every file
// that it names, and the table of its light, which is made here. The unit is loaded and stepped
// once before it is packed. InputError where the experiment cannot run or a file is missing.
RunResult pack_unit(const RunOptions& options, const Console& console, FmiVersion version);

}  // namespace photorque
