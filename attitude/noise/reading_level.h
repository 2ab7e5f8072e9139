// The noise of one channel from its own readings, where no other instrument checks it.
#pragma once

#include <optional>
#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// Standard deviation of one reading of a channel (Observation::rows_of), from divided third
// differences of neighbouring readings, which motion that is smooth from one to the next hardly
// enters, however unevenly they lie; from those of an order up to the sixth where that is quieter
// by half; at least that of the steps in which the channel is written. The motion's own roughness
// counts as noise. Nothing where there are fewer than ten differences.
std::optional<double> reading_level(const std::vector<Observation>& runs, int channel);

}  // namespace photorque
