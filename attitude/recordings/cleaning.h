// Repairs of a recording that has been read: sign flips, bad quaternions, outliers, gaps.
#pragma once

#include "attitude/recordings/recording.h"

namespace photorque {

// Works on the channels q_w, q_x, q_y, q_z, when all four are there: empties quaternions whose norm
// is not 1 to 1 %, normalises the others and gives them the sign of the one before.
void repair_quaternions(Recording& recording);

// Empties cells of attitude and gyro channels that stand far from all their neighbours (a Hampel
// filter: further from the median of the three on either side than 12 standard deviations of the
// channel's noise and 12 times their median deviation). Steps and fast motion stay. Also cells of a
// channel that stands still five rows or longer, and those next to them, where what is read
// otherwise has a noise too fine for that: a gyro at the end of its range, a camera that repeats
// its last attitude.
void remove_outliers(Recording& recording);

// Median interval, jitter and gaps.
void measure_times(Recording& recording);

}  // namespace photorque
