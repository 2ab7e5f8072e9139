#include "attitude/noise/reading_level.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

struct ReadingAt {
  double time_s, value;
};

// The channel's readings as one reading would be: means of n are noisier by √n. Angles are unwound.
std::vector<ReadingAt> readings_of(const Observation& seen, int channel) {
  std::vector<ReadingAt> all;
  double angle_rad = 0.0;
  size_t before = seen.blocks();
  for (size_t i = 0; i < seen.blocks(); ++i) {
    const double rows = seen.rows_of(i, channel);
    if (!(rows > 0.0)) continue;
    if (channel >= vector_channels) {
      const auto scalar = static_cast<size_t>(channel - vector_channels);
      all.push_back({seen.time_s[i], seen.scalar[scalar].value[i]});
      continue;
    }
    if (channel >= 3) {
      all.push_back({seen.time_s[i], seen.gyro_rad_s[i][channel - 3]});
      continue;
    }
    if (before < seen.blocks()) {
      const Quat turn = seen.attitude[i] * seen.attitude[before].conjugate();
      angle_rad += rotation_vector(turn)[channel];
    }
    before = i;
    all.push_back({seen.time_s[i], angle_rad});
  }
  return all;
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

// The divided difference of `order` + 1 readings from the one at `first`, which no polynomial below
// that order enters, however unevenly they lie; over the noise of one reading it has unit variance.
double difference(const std::vector<ReadingAt>& x, size_t first, size_t order) {
  double sum = 0.0, squares = 0.0;
  const double unit_s = (x[first + order].time_s - x[first].time_s) / static_cast<double>(order);
  for (size_t k = first; k <= first + order; ++k) {
    double product = 1.0;
    for (size_t j = first; j <= first + order; ++j) {
      if (j != k) product *= (x[k].time_s - x[j].time_s) / unit_s;
    }
    sum += x[k].value / product;
    squares += 1.0 / (product * product);
  }
  return sum / std::sqrt(squares);
}

// What readings differ by, and by how much those differences do: multiples of the last digit, and
// the smaller ones of both where something moves steadily. Less than rounding leaves is none.
void collect_steps(const std::vector<ReadingAt>& x, std::vector<double>& steps) {
  double largest = 0.0;
  for (const ReadingAt& reading : x) largest = std::max(largest, std::abs(reading.value));
  const double rounding = 1e-12 * largest;
  for (size_t i = 1; i < x.size(); ++i) {
    const double step = x[i].value - x[i - 1].value;
    if (std::abs(step) > rounding) steps.push_back(std::abs(step));
    if (i < 2) continue;
    const double change = step - (x[i - 1].value - x[i - 2].value);
    if (std::abs(change) > rounding) steps.push_back(std::abs(change));
  }
}

double median(std::vector<double>& of) {
  const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
  std::nth_element(of.begin(), middle, of.end());
  return *middle;
}

}  // namespace

std::optional<double> reading_level(const std::vector<Observation>& runs, int channel) {
  constexpr size_t lowest_order = 3, highest_order = 6, fewest = 10;
  std::vector<std::vector<double>> sizes(highest_order + 1);
  std::vector<double> steps;
  for (const Observation& seen : runs) {
    const std::vector<ReadingAt> x = readings_of(seen, channel);
    const double one = std::sqrt(mean_rows(seen, channel));
    for (size_t order = lowest_order; order <= highest_order; ++order) {
      for (size_t i = 0; i + order < x.size(); ++i) {
        sizes[order].push_back(one * std::abs(difference(x, i, order)));
      }
    }
    collect_steps(x, steps);
  }
  if (sizes[lowest_order].size() < fewest) return std::nullopt;
  // The median of |x| of a Gaussian is 0.6745 σ.
  double level = median(sizes[lowest_order]) / 0.6745;
  // White noise is alike at every order. Where the next is quieter by half, what this one holds is
  // motion that the readings follow too coarsely.
  constexpr double quieter = 0.5;
  for (size_t order = lowest_order + 1; order <= highest_order; ++order) {
    if (sizes[order].size() < fewest) break;
    const double next = median(sizes[order]) / 0.6745;
    if (!(next < quieter * level)) break;
    level = next;
  }
  const double step = steps.empty() ? 0.0 : *std::min_element(steps.begin(), steps.end());
  const double least = std::max(level, step / std::sqrt(12.0));
  if (!(least > 0.0)) return std::nullopt;
  return least;
}

}  // namespace photorque
