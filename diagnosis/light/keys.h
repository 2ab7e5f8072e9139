// Keys of the diagnosis of light.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// The kinds of [[effect]] on light and power, from their registry. Kinds with equal names form one
// choice with the keys of all.
std::vector<Key::Choice> light_effects();

}  // namespace photorque
