// The keys as a JSON Schema (draft 7), which editors of TOML complete and check with.
#pragma once

#include <string>
#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// The schema of a file with these tables. The descriptions contain units, ranges and defaults. Any
// unit of a quantity is accepted, with the bounds in that unit. Keys of a choice (`kind`,
// `profile`) are accepted only with it, and unknown keys are rejected. `check` tests conditions on
// several keys or on files.
//
// Conditions are in `if` and `then`, and all properties are on the same level, because taplo does
// not evaluate conditions when it completes and shows keys.
std::string json_schema(const std::vector<Key>& tables);

}  // namespace photorque
