// Readings of a quantity that is constant over intervals of time.
#pragma once

#include <cmath>
#include <span>

namespace photorque {

// Replaces each value by the mean of its steady interval. An interval ends at a value that differs
// by more than `most` from the mean so far.
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
