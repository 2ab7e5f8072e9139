// A recording as stretches of undisturbed motion: it is cut where something hit the platform and
// where nothing was read for long.
#pragma once

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
  int64_t too_short = 0;  // stretches with too few readings for a start of their own: left out
  std::optional<AngleConvention> angles;  // how roll, pitch and yaw were read
  std::vector<std::string> lawless;       // why parts of stretches are left out (law_breaks.h)
};

// `max_blocks`: of all stretches together. InputError as observe() (observation.h), and where every
// stretch is too short.
Segments observe_segments(const Recording& recording, const std::string& name,
                          const Platform& platform, size_t max_blocks = 6000);

// Refuses a gap more than ten times as long as all that was recorded (InputError with its
// instants): a clock that was set while it recorded, or two recordings in one. No search for what
// acts over such a span ends.
void refuse_jump_of_clock(const Recording& recording, const std::string& name);

}  // namespace photorque
