// Keys of a manufacturer's values, for fits of cells and modules.
#pragma once

#include <vector>

#include "core/settings/typed_keys.h"
#include "photovoltaics/fit/fit.h"

namespace photorque {

// One [[datasheet]], and its keys.
RatedPoint read_rated_point(const Settings& point);
std::vector<Key> rated_point_keys();
// Temperature slopes of the values, and their keys.
TemperatureSlopes read_rated_slopes(const Settings& settings);
// The slopes that are not stated, as keys with their assumed values.
std::string assumed_slopes(const Settings& settings);
std::vector<Key> rated_slope_keys();

}  // namespace photorque
