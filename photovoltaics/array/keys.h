// The keys of [array] that this room reads, as they are declared.
#pragma once

#include <vector>

#include "core/settings/keys.h"

namespace photorque {

// read_array_design() and read_cell_places(), with [array.cover], the diodes and the cell.
std::vector<Key> array_design_keys();
// read_trackers().
std::vector<Key> tracker_keys();
// read_day().
std::vector<Key> day_keys();

}  // namespace photorque
