// Thinning of long series of numbers for plots.
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

}  // namespace photorque
