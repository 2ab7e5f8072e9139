// modelDescription.xml of a co-simulation unit.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/fmi/unit.h"
#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

// `name` of the model, `token` that a unit is instantiated with, `tool` that made it.
std::string model_description(const UnitDescription& unit, const std::string& name,
                              const std::string& token, const std::string& tool);

// ZIP archives.

// A ZIP archive of files (name with '/', bytes) in this order, deflated, without dates: equal files
// give equal bytes. Source: PKWARE's APPNOTE 6.3.10, sections 4.3.7, 4.3.12 and 4.3.16.
// InputError for more than 65535 files or 4 GiB.
std::string zip_archive(const std::vector<std::pair<std::string, std::string>>& files);

// `fmu`: an experiment as a co-simulation unit of FMI 3.0.

// NAME.fmu: modelDescription.xml, the library, the experiment with its overrides and every file
// that it names, and the table of its light, which is made here. The unit is loaded and stepped
// once before it is packed. InputError where the experiment cannot run or a file is missing.
RunResult pack_unit(const RunOptions& options, const Console& console);

}  // namespace photorque
