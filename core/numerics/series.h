// Series of readings: thinning for plots, means of steady intervals.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace photorque {

// Indices of about `most` values of a series: the lowest and the highest value of every interval,
// so that no peak is lost. All indices if there are at most `most` values.
inline std::vector<size_t> lows_and_highs(std::span<const double> values, size_t most) {
  const size_t intervals = values.size() <= most ? values.size() : std::max<size_t>(1, most / 2);
  std::vector<size_t> kept;
  for (size_t s = 0; s < intervals; ++s) {
    const size_t from = s * values.size() / intervals, to = (s + 1) * values.size() / intervals;
    size_t low = from, high = from;
    for (size_t i = from; i < to; ++i) {
      if (values[i] < values[low] || !std::isfinite(values[low])) low = i;
      if (values[i] >= values[high] || !std::isfinite(values[high])) high = i;
    }
    kept.push_back(std::min(low, high));
    if (low != high) kept.push_back(std::max(low, high));
  }
  return kept;
}

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
