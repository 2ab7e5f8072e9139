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

// InputError with the times of a jump of the clock (recordings/cleaning.h). A search for effects
// over such an interval does not end.
void refuse_jump_of_clock(const Recording& recording, const std::string& name);

// Whether any command, current or wheel speed is recorded.
bool is_commanded(const Schedule& schedule);

}  // namespace photorque
