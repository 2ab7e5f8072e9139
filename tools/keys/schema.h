// The keys as a JSON Schema (draft 7), which editors of TOML complete and check with.
#pragma once

#include <string>
#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// The schema of a file that holds these tables. Units, ranges and defaults stand in the
// descriptions as well; any unit of a quantity is taken, with the bounds in that unit. What a
// choice brings (`kind`, `profile`) is known with it alone, and nothing else is known. What rests
// on several keys or on files is left to `check`.
//
// Conditions stand in `if` and `then`, and all properties beside each other: so taplo, which
// follows no conditions when it completes and shows, finds every key.
std::string json_schema(const std::vector<Key>& tables);

}  // namespace photorque
