// The tables of an experiment that the program itself reads, as they are declared.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

Key array_table();      // tools/runs
Key published_table();  // tools/runs
Key light_table();      // tools/coupling
Key sweep_table();      // tools/sweeps
Key fit_table();        // tools/verbs

}  // namespace photorque
