// Where a machine that turns about one axis ceases to follow one law: the drive that spun it up is
// released, a hand brakes it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// Rows [first, last) in which the rate follows one law.
struct LawfulStretch {
  size_t first = 0, last = 0;
  std::string left_out;  // why the rest is left out; empty: nothing is
};

// The longest part of the rows [first, last) between breaks. A torque that depends on angle and
// rate cannot change its rate's slope at once while both go on as before; such a break is told by
// straight lines through the rates on both sides, over 12 rows and more, whose slopes differ by
// half of the larger one, by ten standard errors and by eight times what is usual in the recording.
// A rate that vanishes or changes its sign is no break (dry friction does that), and where commands
// or measured wheels act none is looked for.
LawfulStretch lawful_stretch(const Observation& rows, const Vec3& axis, size_t first, size_t last);

}  // namespace photorque
