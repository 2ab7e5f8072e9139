// The measured speeds of wheels, as a schedule holds them.
#pragma once

#include <vector>

#include "attitude/model/schedule.h"
#include "attitude/recordings/recording.h"

namespace photorque {

// Straight lines between means over neighbouring rows, so many that what lies between is straight,
// and no more: each begins a step of the propagation. Of `wheel_x_rad_s` …; empty without any.
std::vector<WheelSpeeds> wheel_speeds(const Recording& recording);

}  // namespace photorque
