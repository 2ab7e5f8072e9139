// The median of some numbers.
#pragma once

#include <algorithm>
#include <vector>

namespace photorque {

// The median; for an even count, the larger of the two middle values. `values` must not be empty.
inline double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The median of the magnitude of a normal variable, in standard deviations.
inline constexpr double normal_median = 0.6745;

}  // namespace photorque
