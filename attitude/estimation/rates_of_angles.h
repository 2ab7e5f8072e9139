// Angles about one axis, and the rates that are computed from them.
#pragma once

#include <optional>

#include "attitude/observation/observation.h"

namespace photorque {

// Whether all rates about the axis are difference quotients of the angle: towards the previous
// reading, the next one, or across both. They must agree to 5 % of the scatter of neighbouring
// quotients. The errors of a second instrument would be independent.
bool is_rate_of_angle(const Observation& rows, const Vec3& axis);
// Removes the rates from the rows.
void drop_rates(Observation& rows);

// The recording with mean rates between the readings instead of the angle, if the angle has fewer
// than nine readings per turn and turns at least ten times in one sense. Such an angle does not
// show the law within a turn. Empty for other recordings, with commands or with other readings of
// the rotation.
std::optional<Recording> with_rates_of_far_turns(const Recording& recording,
                                                 const Platform& platform);

}  // namespace photorque
