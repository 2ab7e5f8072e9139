// The noise of one channel from its own readings, where no other instrument checks it.
#pragma once

#include <optional>
#include <vector>

#include "attitude/estimation/observation.h"

namespace photorque {

// Standard deviation of one reading of a channel (Observation::rows_of), from third differences of
// neighbouring readings, which motion that is smooth from one to the next hardly enters; at least
// that of the steps in which the channel is written. The motion's own roughness counts as noise.
// Nothing where there are fewer than ten differences.
std::optional<double> reading_level(const std::vector<Observation>& runs, int channel);

}  // namespace photorque
