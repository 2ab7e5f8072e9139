// The keys of a maker's figures, for whoever fits a cell or module to them.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// One point of a datasheet.
std::vector<Key> rated_point_keys();
// How its figures change with the temperature.
std::vector<Key> rated_slope_keys();

}  // namespace photorque
