#include "attitude/noise/reading_level.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

// The channel's readings as one reading would be: means of n are noisier by √n. Angles are unwound.
std::vector<double> readings_of(const Observation& seen, int channel) {
  std::vector<double> values;
  double angle_rad = 0.0;
  size_t before = seen.blocks();
  for (size_t i = 0; i < seen.blocks(); ++i) {
    const double rows = seen.rows_of(i, channel);
    if (!(rows > 0.0)) continue;
    if (channel >= 3) {
      values.push_back(seen.gyro_rad_s[i][channel - 3]);
      continue;
    }
    if (before < seen.blocks()) {
      const Quat turn = seen.attitude[i] * seen.attitude[before].conjugate();
      angle_rad += rotation_vector(turn)[channel];
    }
    before = i;
    values.push_back(angle_rad);
  }
  return values;
}

double mean_rows(const Observation& seen, int channel) {
  double sum = 0.0, count = 0.0;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    const double rows = seen.rows_of(i, channel);
    sum += rows;
    count += rows > 0.0 ? 1.0 : 0.0;
  }
  return count > 0.0 ? sum / count : 1.0;
}

}  // namespace

std::optional<double> reading_level(const std::vector<Observation>& runs, int channel) {
  std::vector<double> sizes, steps;
  for (const Observation& seen : runs) {
    const std::vector<double> x = readings_of(seen, channel);
    const double one = std::sqrt(mean_rows(seen, channel));
    for (size_t i = 3; i < x.size(); ++i) {
      sizes.push_back(one * std::abs(x[i] - 3 * x[i - 1] + 3 * x[i - 2] - x[i - 3]));
      const double step = std::abs(x[i] - x[i - 1]);
      if (step > 0.0) steps.push_back(step);
    }
  }
  constexpr size_t fewest = 10;
  if (sizes.size() < fewest) return std::nullopt;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  // The median of |x| of a Gaussian is 0.6745 σ; third differences have 20 times the variance.
  const double level = *middle / 0.6745 / std::sqrt(20.0);
  const double step = steps.empty() ? 0.0 : *std::min_element(steps.begin(), steps.end());
  const double least = std::max(level, step / std::sqrt(12.0));
  if (!(least > 0.0)) return std::nullopt;
  return least;
}

}  // namespace photorque
