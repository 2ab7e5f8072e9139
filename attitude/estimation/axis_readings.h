// The readings of one angle or one rate about the axis of a body that turns about it alone.
#pragma once

#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// Only rows with a reading.
struct AxisReadings {
  std::vector<size_t> row;
  std::vector<double> time_s, value;  // rad or rad/s
};

// Angles in the rows [first, last), whole turns counted.
AxisReadings angles_about(const Observation& rows, const Vec3& axis, size_t first, size_t last);
// Rates in the rows [first, last).
AxisReadings rates_about(const Observation& rows, const Vec3& axis, size_t first, size_t last);

// The first of the rows [first, last) after a rest from which the body sets off at once, as where a
// motor is switched on or a hand lets go. While it rests, at least five readings scatter about one
// value as noise does, for a rate about zero, without a slope. At most twelve readings later all of
// the next are further away than five times that scatter, on one side, and with their slope the
// body would have moved by ten times the scatter within the rest. `first` where there is no such
// rest.
size_t start_of_motion(const Observation& rows, const Vec3& axis, size_t first, size_t last);

}  // namespace photorque
