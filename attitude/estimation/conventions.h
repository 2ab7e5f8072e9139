// Frame and convention checks before any physics: the rates must integrate to the attitude.
#pragma once

#include <string>

#include "attitude/estimation/observation.h"

namespace photorque {

// When gyro and attitude contradict each other as read, and one other reading of the same numbers
// (quaternion conjugated, scalar last, axes permuted or reversed, degrees per second under a header
// that says radians or the reverse) makes them agree, the observation is changed to that reading
// and a sentence says so. Empty: nothing was changed. An observation without gyro cannot be
// checked.
std::string repair_conventions(Observation& seen);

}  // namespace photorque
