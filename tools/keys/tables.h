// The tables of an experiment that the program itself reads, as they are declared.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

Key sweep_table();      // tools/sweeps

}  // namespace photorque
