// Angles about one axis, and the rates that are computed from them.
#pragma once

#include <optional>

#include "attitude/observation/observation.h"

namespace photorque {

// Whether every rate about the axis is the difference quotient of the angle: from the reading
// before, to the reading after, or between both, to a twentieth of what neighbouring quotients
// scatter. The errors of a second instrument would be independent.
bool is_rate_of_angle(const Observation& rows, const Vec3& axis);
void drop_rates(Observation& rows);

// An angle with fewer than nine readings a turn that turns in one sense, ten times at least, does
// not show the law within a turn: the recording with mean rates between its readings instead.
// Empty for other recordings, with commands or with other readings of the rotation.
std::optional<Recording> with_rates_of_far_turns(const Recording& recording,
                                                 const Platform& platform);

}  // namespace photorque
