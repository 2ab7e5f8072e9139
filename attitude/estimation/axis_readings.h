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

}  // namespace photorque
