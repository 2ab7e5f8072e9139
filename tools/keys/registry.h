// All keys of an experiment.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// The tables of an experiment, in the order in which documents show them.
std::vector<Key> experiment_keys();

}  // namespace photorque
