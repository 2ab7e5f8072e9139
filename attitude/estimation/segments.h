// Cuts a recording into segments of undisturbed motion: at impacts on the platform and at long gaps
// between readings.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "attitude/estimation/conventions.h"
#include "attitude/observation/observation.h"

namespace photorque {

struct Segments {
  std::vector<Observation> all;
  int64_t events = 0;     // rows with a recorded impact, left out
  int64_t kinks = 0;      // rows at which a rate changes suddenly, left out
  int64_t long_gaps = 0;  // at which the recording was cut
  int64_t too_short = 0;  // segments with too few readings for an initial state, left out
  std::optional<AngleConvention> angles;  // the convention used for roll, pitch and yaw
  std::vector<std::string> notes;         // on columns that are converted or left out
  std::vector<std::string> exclusions;  // why parts of segments are left out (consistent_segment())
};

// Cuts a recording into segments. `max_blocks`: maximum number of blocks of all segments together.
// InputError as observe() (observation.h), and if every segment is too short.
Segments observe_segments(const Recording& recording, const std::string& name,
                          const Platform& platform, size_t max_blocks = 6000);

// InputError with the times of a gap that is more than ten times as long as all recorded time.
// Causes are a clock that was set during the recording, or two recordings in one file. A search for
// effects over such an interval does not end.
void refuse_jump_of_clock(const Recording& recording, const std::string& name);

// Whether any command, current or wheel speed is recorded.
bool is_commanded(const Schedule& schedule);

// Rows [first, last) in which the rate about one axis follows one law.
struct ConsistentSegment {
  size_t first = 0, last = 0;
  std::string left_out;  // the reason for leaving out the rest; empty: nothing is left out
};

// The longest part of the rows [first, last) without a change of the law, for example by a drive
// that is released or a hand that brakes. A torque that depends on angle and rate cannot change the
// slope of the rate suddenly while angle and rate are continuous. Such a break is detected by
// straight lines through the rates on both sides, over at least 12 rows. Their slopes must differ
// by half of the larger slope, by ten standard errors and by eight times the median difference in
// the recording. Rates near zero or with a change of sign are not tested, because dry friction
// causes breaks there. All rows are returned if commands or measured wheels act, or if a weight
// exerts a torque once per turn.
ConsistentSegment consistent_segment(const Observation& rows, const Vec3& axis, size_t first,
                                     size_t last);

}  // namespace photorque
