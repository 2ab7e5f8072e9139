// The tables of an experiment that this room reads, and what sources, receivers and materials read
// of them.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// [scene], [[material]], [[source]], [[receiver]], [attitude], [trace], [torque_map], [camera].
std::vector<Key> scene_tables();

}  // namespace photorque
