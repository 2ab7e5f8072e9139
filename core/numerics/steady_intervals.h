// Readings of something that is held constant for intervals of time.
#pragma once

#include <cmath>
#include <span>

namespace photorque {

// Puts the mean of its steady interval in the place of each value. An interval ends where a value
// is further than `most` from the mean so far.
inline void hold_means(std::span<double> values, double most) {
  for (size_t begin = 0, end = 0; begin < values.size(); begin = end) {
    double sum = 0.0;
    for (end = begin; end < values.size(); ++end) {
      const auto count = static_cast<double>(end - begin);
      if (end > begin && std::abs(values[end] - sum / count) > most) break;
      sum += values[end];
    }
    for (size_t i = begin; i < end; ++i) values[i] = sum / static_cast<double>(end - begin);
  }
}

}  // namespace photorque
