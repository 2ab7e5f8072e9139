// Repairs of a recording: sign flips, bad quaternions, held readings, outliers, gaps.
#pragma once

#include <optional>
#include <string>

#include "attitude/recordings/recording.h"

namespace photorque {

// Repairs the channels q_w, q_x, q_y, q_z if all four exist: empties quaternions whose norm is not
// 1 to 1 %, normalises the others and gives them the sign of the previous one.
void repair_quaternions(Recording& recording);

// Empties outliers of attitude and gyro channels. A cell is an outlier if it deviates from the
// neighbours on both sides like a spike from a smooth motion. It is also an outlier by a Hampel
// filter: its distance from the median of the three neighbours on either side exceeds 12 standard
// deviations of the channel's noise and 12 times their median deviation. Steps and fast motion are
// kept.
//
// Also empties cells of a channel that is constant for five rows or longer, and those next to them,
// if the channel's noise is otherwise too fine for equal readings. Examples are a gyro at the end
// of its range and a camera that repeats its last attitude.
void remove_outliers(Recording& recording);

// Keeps the first row of each reading if the log is faster than a sensor and repeats its readings
// (sample and hold), as repetitions are not independent. All channels of the sensor are then equal
// in runs that nearly all have the same length, or two that differ by one row. Empties the other
// cells of the sensor, and removes rows without a reading unless a command or an event changes. A
// slow motion in coarse digits and a body at rest are kept.
void remove_held_readings(Recording& recording);

// The finding of remove_held_readings() as a note.
std::string held_readings_text(const RecordingReport& report);

// Sets median interval, jitter and gaps of the report.
void measure_times(Recording& recording);

// A gap that is more than ten times as long as all recorded time. Causes are a clock that was set
// during the recording, or two recordings in one file.
struct ClockJump {
  RecordingReport::Gap gap;
  double recorded_s = 0.0;  // without gaps
};

// The longest such gap of the report; nothing without one.
std::optional<ClockJump> jump_of_clock(const Recording& recording);

// Leaves out the first or last one or two rows if such a gap separates them from at least twenty
// others, as a row of zeros before the clock runs.
void omit_isolated_rows(Recording& recording);

}  // namespace photorque
