// Rows of an observation on their way to one, and what their mean holds of the motion.
#pragma once

#include <cstddef>

#include "attitude/observation/observation.h"

namespace photorque {

// All of an observation but its blocks.
Observation without_blocks(const Observation& seen);

// Appends the mean of the rows [first, last) of `from` as a block.
void append_mean(const Observation& from, size_t first, size_t last, Observation& to);

// Makes the first block of `to`, a mean that is the given block of `all`, a reading at its middle,
// as far as its neighbours there tell how the motion curves.
void straighten_first(const Observation& all, size_t block, Observation& to);

}  // namespace photorque
