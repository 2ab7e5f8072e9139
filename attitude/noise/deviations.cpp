#include "attitude/noise/deviations.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace photorque {
namespace {

constexpr size_t reach = deviation_window / 2;
constexpr size_t lags = 5;

// Correlation at each lag of what a parabola through a window leaves of white noise at its middle.
std::array<double, lags + 1> correlations_of_white_noise() {
  // Weights of the value at the middle (Savitzky and Golay, Anal. Chem. 36, 1627, 1964).
  const double m = reach;
  std::vector<double> kept(deviation_window);
  for (size_t j = 0; j < deviation_window; ++j) {
    const double x = static_cast<double>(j) - m;
    kept[j] = -(3.0 * (3.0 * m * m + 3.0 * m - 1.0) - 15.0 * x * x) /
              ((2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0));
  }
  kept[reach] += 1.0;
  std::array<double, lags + 1> all{};
  for (size_t lag = 0; lag <= lags; ++lag) {
    for (size_t j = lag; j < deviation_window; ++j) all[lag] += kept[j] * kept[j - lag];
  }
  for (size_t lag = lags + 1; lag-- > 0;) all[lag] /= all[0];
  return all;
}

}  // namespace

Deviations deviations(const Prediction& residuals, const Observation& seen, int channel) {
  Deviations result;
  for (size_t i = 0; i < residuals.off.size(); ++i) {
    const double x = residuals.off[i][channel];
    const double rows = seen.rows_of(i, channel);
    // An attitude that is elsewhere may be a turn off in its next reading.
    constexpr double elsewhere_rad = 0.5;
    if (!std::isfinite(x) || !(rows > 0.0) || (channel < 3 && std::abs(x) > elsewhere_rad))
      continue;
    result.block.push_back(i);
    result.time_s.push_back(seen.time_s[i]);
    result.left.push_back(x);
    result.root_rows.push_back(std::sqrt(rows));
  }
  if (result.count() < deviation_window) return {};
  lay_curves(result, std::vector<double>(result.count(), 1.0));
  return result;
}

void lay_curves(Deviations& channel, const std::vector<double>& weight) {
  const size_t n = channel.count();
  channel.curve.resize(n);
  channel.size.resize(n);
  for (size_t i = 0; i < n; ++i) {
    const size_t first = std::min(i < reach ? 0 : i - reach, n - deviation_window);
    const double length_s = channel.time_s[first + deviation_window - 1] - channel.time_s[first];
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const auto weight_of = [&](size_t j) {
      return weight[j] * channel.root_rows[j] * channel.root_rows[j];
    };
    for (size_t j = first; j < first + deviation_window; ++j) {
      const double x = (channel.time_s[j] - channel.time_s[i]) / length_s;
      const Eigen::Vector3d row(1.0, x, x * x);
      matrix.noalias() += weight_of(j) * row * row.transpose();
      right += weight_of(j) * channel.left[j] * row;
    }
    const Eigen::Matrix3d inverse = matrix.inverse();
    channel.curve[i] = inverse.row(0).dot(right);
    // At the ends a curve follows its last reading; that it leaves nothing is no precision.
    constexpr double least_left = 0.05;
    const double left = std::max(1.0 - weight_of(i) * inverse(0, 0), least_left);
    channel.size[i] = channel.root_rows[i] * (channel.left[i] - channel.curve[i]) / std::sqrt(left);
  }
}

double robust_level(const std::vector<Deviations>& runs) {
  std::vector<double> sizes;
  for (const Deviations& run : runs) {
    for (const double x : run.size) sizes.push_back(std::abs(x));
  }
  if (sizes.empty()) return 0.0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  // The median of |x| of a normal distribution is 0.6745 σ.
  return *middle / 0.6745;
}

bool are_independent(const std::vector<Deviations>& runs, double level) {
  static const std::array<double, lags + 1> white = correlations_of_white_noise();
  std::array<double, lags + 1> product{};
  double count = 0.0;
  for (const Deviations& run : runs) {
    constexpr double most = 3.0;
    const auto cut = [&](size_t i) { return std::clamp(run.size[i] / level, -most, most); };
    for (size_t i = lags; i < run.count(); ++i) {
      for (size_t lag = 0; lag <= lags; ++lag) product[lag] += cut(i) * cut(i - lag);
      count += 1.0;
    }
  }
  if (!(count > 0.0) || !(product[0] > 0.0)) return false;
  for (size_t lag = 1; lag <= lags; ++lag) {
    // Where readings are missing and about large errors the parabola is another.
    constexpr double tolerance = 0.05, sigmas = 5.0;
    const double off = std::abs(product[lag] / product[0] - white[lag]);
    if (off > tolerance + sigmas / std::sqrt(count)) return false;
  }
  return true;
}

}  // namespace photorque
