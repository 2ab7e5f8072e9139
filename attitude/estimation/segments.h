// A recording as segments of undisturbed motion: it is cut where something hit the platform and
// where nothing was read for long.
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
  int64_t events = 0;     // rows in which something hit the platform: left out
  int64_t kinks = 0;      // rows at which an angle changes its rate at once: left out as well
  int64_t long_gaps = 0;  // at which the recording was cut
  int64_t too_short = 0;  // segments with too few readings for an initial state, left out
  std::optional<AngleConvention> angles;  // how roll, pitch and yaw were read
  std::vector<std::string> notes;         // on columns that are read otherwise or left out
  std::vector<std::string> exclusions;  // why parts of segments are left out (consistent_segment())
};

// `max_blocks`: of all segments together. InputError as observe() (observation.h), and where every
// segment is too short.
Segments observe_segments(const Recording& recording, const std::string& name,
                          const Platform& platform, size_t max_blocks = 6000);

// Refuses a gap more than ten times as long as all that was recorded (InputError with its
// instants): a clock that was set while it recorded, or two recordings in one. No search for
// effects over such a span ends.
void refuse_jump_of_clock(const Recording& recording, const std::string& name);

// Detection of changes of the law of rotation about one axis: a drive is released, a hand brakes.

// Rows [first, last) in which the rate follows one law.
struct ConsistentSegment {
  size_t first = 0, last = 0;
  std::string left_out;  // why the rest is left out; empty: nothing is
};

// The longest part of the rows [first, last) between breaks. A torque that depends on angle and
// rate cannot change its rate's slope at once while both go on as before; such a break is
// identified by straight lines through the rates on both sides, over 12 rows and more, whose slopes
// differ by half of the larger one, by ten standard errors and by eight times what is usual in the
// recording. A rate that vanishes or changes its sign is no break (dry friction does that), and
// where commands or measured wheels act none is looked for.
ConsistentSegment consistent_segment(const Observation& rows, const Vec3& axis, size_t first,
                                     size_t last);

}  // namespace photorque
