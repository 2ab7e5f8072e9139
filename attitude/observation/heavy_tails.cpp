#include "attitude/observation/heavy_tails.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/median.h"

namespace photorque {

namespace {

// The deviations of one channel in one run, in order of time.
struct Deviations {
  std::vector<size_t> block;  // of the observation
  std::vector<double> time_s;
  std::vector<double> left;       // measured − predicted [rad or rad/s]
  std::vector<double> root_rows;  // √ of the rows that were averaged into the block
  std::vector<double> curve;      // smooth curve through the neighbours
  // left − curve, scaled to one row and divided by the square root of the fraction of a reading's
  // variance that remains about the curve. For white noise its standard deviation is that of the
  // noise.
  std::vector<double> size;

  size_t count() const { return block.size(); }
};

// Number of readings in the window of the parabola about each reading, including it.
constexpr size_t deviation_window = 15;
constexpr size_t reach = deviation_window / 2;
constexpr size_t lags = 5;

// Autocorrelation, at each lag, of the residuals at the centre of a moving parabola, for white
// noise.
std::array<double, lags + 1> correlations_of_white_noise() {
  // Weights of the value at the centre (Savitzky and Golay, Anal. Chem. 36, 1627, 1964).
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

// Fits the curves again, with one weight (> 0) for each reading.
void fit_smooth_curves(Deviations& channel, const std::vector<double>& weight) {
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
    // At the ends of the data the curve nearly passes through the readings, so that a small
    // residual there is no sign of precision.
    constexpr double least_left = 0.05;
    const double left = std::max(1.0 - weight_of(i) * inverse(0, 0), least_left);
    channel.size[i] = channel.root_rows[i] * (channel.left[i] - channel.curve[i]) / std::sqrt(left);
  }
}

// The deviations with equal weights; empty if there are fewer readings than a window.
Deviations deviations(const Prediction& residuals, const Observation& seen, int channel) {
  Deviations result;
  for (size_t i = 0; i < residuals.off.size(); ++i) {
    const double x = residuals.off[i][channel];
    const double rows = seen.rows_of(i, channel);
    // A residual of this size may be a whole turn at the next reading.
    constexpr double elsewhere_rad = 0.5;
    if (!std::isfinite(x) || !(rows > 0.0) || (channel < 3 && std::abs(x) > elsewhere_rad))
      continue;
    result.block.push_back(i);
    result.time_s.push_back(seen.time_s[i]);
    result.left.push_back(x);
    result.root_rows.push_back(std::sqrt(rows));
  }
  if (result.count() < deviation_window) return {};
  fit_smooth_curves(result, std::vector<double>(result.count(), 1.0));
  return result;
}

// Standard deviation from the median of all sizes, which outliers do not affect. 0: no reading.
double robust_level(const std::vector<Deviations>& runs) {
  std::vector<double> sizes;
  for (const Deviations& run : runs) {
    for (const double x : run.size) sizes.push_back(std::abs(x));
  }
  if (sizes.empty()) return 0.0;
  return upper_median(std::move(sizes)) / normal_median;
}

// Whether the correlation of neighbouring deviations is that of white noise about its fitted curve:
// the residual is then noise, not motion. Sizes are clipped at three times `level`.
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
    // Missing readings and large errors change the parabola; the tolerance allows for them.
    constexpr double tolerance = 0.05, sigmas = 5.0;
    const double off = std::abs(product[lag] / product[0] - white[lag]);
    if (off > tolerance + sigmas / std::sqrt(count)) return false;
  }
  return true;
}

std::vector<Deviations> of_all(const std::vector<Prediction>& residuals,
                               const std::vector<Observation>& runs, int channel) {
  std::vector<Deviations> all;
  for (size_t run = 0; run < runs.size(); ++run) {
    all.push_back(deviations(residuals[run], runs[run], channel));
  }
  return all;
}

size_t count_of(const std::vector<Deviations>& runs) {
  size_t count = 0;
  for (const Deviations& run : runs) count += run.count();
  return count;
}

// The mean of a function of the deviations in all runs.
template <class Function>
double mean_over(const std::vector<Deviations>& runs, const Function& f) {
  double sum = 0.0;
  for (const Deviations& run : runs) {
    for (const double x : run.size) sum += f(x);
  }
  return sum / static_cast<double>(count_of(runs));
}

double mean_square(const std::vector<Deviations>& runs) {
  return mean_over(runs, [](double x) { return x * x; });
}

double weight_of(double size, double degrees, double scale) {
  const double x = size / scale;
  return (degrees + 1.0) / (degrees + x * x);
}

void weigh(std::vector<Deviations>& runs, double degrees, double scale) {
  for (Deviations& run : runs) {
    if (run.count() == 0) continue;
    std::vector<double> weight;
    for (const double x : run.size) weight.push_back(weight_of(x, degrees, scale));
    fit_smooth_curves(run, weight);
  }
}

// The maximum-likelihood scale, whose square equals the weighted mean square.
double max_likelihood_scale(const std::vector<Deviations>& runs, double degrees, double scale) {
  constexpr int most_steps = 100;
  constexpr double close = 1e-5;
  for (int step = 0; step < most_steps; ++step) {
    const double next =
        std::sqrt(mean_over(runs, [&](double x) { return weight_of(x, degrees, scale) * x * x; }));
    const bool is_there = std::abs(next - scale) < close * scale;
    scale = next;
    if (is_there) break;
  }
  return scale;
}

// −2 ln of the likelihood under Student's t.
double under_t(const std::vector<Deviations>& runs, double degrees, double scale) {
  double sum = 0.0;
  for (const Deviations& run : runs) {
    for (const double x : run.size) {
      sum += (degrees + 1.0) * std::log1p(x * x / (degrees * scale * scale));
    }
  }
  const auto count = static_cast<double>(count_of(runs));
  const double norm = std::lgamma(0.5 * (degrees + 1.0)) - std::lgamma(0.5 * degrees) -
                      0.5 * std::log(degrees * pi * scale * scale);
  return sum - 2.0 * count * norm;
}

double under_normal(const std::vector<Deviations>& runs) {
  double sum = 0.0;
  for (const Deviations& run : runs) {
    for (const double x : run.size) sum += x * x;
  }
  const auto count = static_cast<double>(count_of(runs));
  return count * (std::log(2.0 * pi * sum / count) + 1.0);
}

struct TailFit {
  double log_degrees = 0.0, scale = 0.0, value = 0.0;
};

// Searches the degrees of freedom from 1 (the Cauchy distribution) to nearly normal, first in large
// steps, then in small steps around the best value.
TailFit max_likelihood_tail(const std::vector<Deviations>& runs, double scale) {
  constexpr double large = 0.25, small = 0.05, longest = 4.0;
  TailFit best{0.0, scale, INFINITY};
  const auto look = [&](double first, double last, double step) {
    double s = best.scale;
    for (double log_degrees = first; log_degrees <= last; log_degrees += step) {
      const double degrees = std::exp(log_degrees);
      s = max_likelihood_scale(runs, degrees, s);
      const double value = under_t(runs, degrees, s);
      if (value < best.value) best = {log_degrees, s, value};
    }
  };
  look(0.0, longest, large);
  const double about = best.log_degrees;
  look(std::max(0.0, about - large + small), std::min(longest, about + large - small), small);
  return best;
}

// Standard deviation of ln ν, from the curvature of the profile likelihood.
double log_degrees_sigma(const std::vector<Deviations>& runs, const TailFit& at) {
  constexpr double step = 0.1;
  double sides = 0.0;
  for (const double side : {-step, step}) {
    const double degrees = std::exp(at.log_degrees + side);
    sides += under_t(runs, degrees, max_likelihood_scale(runs, degrees, at.scale));
  }
  const double curvature = (sides - 2.0 * at.value) / (step * step);  // of −2 ln L
  return curvature > 0.0 ? std::sqrt(2.0 / curvature) : INFINITY;
}

// Whether many readings equal the previous one: such a coarse resolution hides tails.
bool are_coarse(const std::vector<Observation>& runs, int channel) {
  constexpr double coarse_fraction = 0.05;
  double same = 0.0, count = 0.0;
  for (const Observation& seen : runs) {
    for (size_t i = 1; i < seen.blocks(); ++i) {
      if (!(seen.rows_of(i, channel) > 0.0)) continue;
      const bool is_same = channel < 3 ? seen.attitude[i].coeffs() == seen.attitude[i - 1].coeffs()
                                       : seen.value_of(i, channel) == seen.value_of(i - 1, channel);
      same += is_same ? 1.0 : 0.0;
      count += 1.0;
    }
  }
  return same > coarse_fraction * count;
}

std::optional<HeavyTail> heavy_tail(std::vector<Deviations> runs, const Thresholds::Noise& limits) {
  if (count_of(runs) < limits.min_tail_readings) return std::nullopt;
  double scale = robust_level(runs);
  if (!(scale > 0.0)) return std::nullopt;
  // Alternates between the weights of the curve and the distribution of its residuals.
  constexpr int turns = 3;
  weigh(runs, 4.0, scale);
  TailFit best = max_likelihood_tail(runs, scale);
  for (int turn = 1; turn < turns; ++turn) {
    weigh(runs, std::exp(best.log_degrees), best.scale);
    best = max_likelihood_tail(runs, best.scale);
  }
  const double degrees = std::exp(best.log_degrees);
  const bool is_heavy = best.value < under_normal(runs) - limits.min_tail_gain;
  if (!is_heavy || degrees > limits.max_tail_degrees) return std::nullopt;
  if (!are_independent(runs, best.scale)) return std::nullopt;
  return HeavyTail{degrees, degrees * log_degrees_sigma(runs, best), best.scale};
}

// Adds `by` [rad or rad/s] to a reading.
void move(Observation& seen, size_t block, int channel, double by) {
  if (channel >= 3) {
    seen.value_of(block, channel) += by;
    return;
  }
  seen.attitude[block] =
      (Quat(Eigen::AngleAxisd(by, Vec3::Unit(channel))) * seen.attitude[block]).normalized();
}

}  // namespace

HeavyTails heavy_tails(const std::vector<Prediction>& residuals,
                       const std::vector<Observation>& runs, const Thresholds::Noise& limits) {
  HeavyTails tails;
  for (int channel = 0; channel < 6; ++channel) {
    if (are_coarse(runs, channel)) continue;
    tails[static_cast<size_t>(channel)] = heavy_tail(of_all(residuals, runs, channel), limits);
  }
  return tails;
}

double deviation_level(const std::vector<Prediction>& residuals,
                       const std::vector<Observation>& runs, int channel) {
  const std::vector<Deviations> all = of_all(residuals, runs, channel);
  return count_of(all) > 0 ? std::sqrt(mean_square(all)) : 0.0;
}

void robustify(const HeavyTails& tails, const std::vector<Prediction>& residuals,
               std::vector<Observation>& runs) {
  for (int channel = 0; channel < 6; ++channel) {
    const std::optional<HeavyTail>& tail = tails[static_cast<size_t>(channel)];
    if (!tail) continue;
    // Divides by the mean slope of the influence function, so that a common shift of all readings
    // is preserved.
    const double slope = (tail->degrees + 1.0) / (tail->degrees + 3.0);
    for (size_t run = 0; run < runs.size(); ++run) {
      std::vector<Deviations> one = {deviations(residuals[run], runs[run], channel)};
      constexpr int turns = 4;
      for (int turn = 0; turn < turns; ++turn) weigh(one, tail->degrees, tail->scale);
      const Deviations& d = one.front();
      for (size_t i = 0; i < d.count(); ++i) {
        const double off = d.left[i] - d.curve[i];
        const double weight = weight_of(off * d.root_rows[i], tail->degrees, tail->scale);
        move(runs[run], d.block[i], channel, (weight / slope - 1.0) * off);
      }
    }
  }
}

int64_t drop_bursts(const std::vector<Prediction>& residuals, const Thresholds::Noise& limits,
                    std::vector<Observation>& runs) {
  int64_t dropped = 0;
  for (int channel = 0; channel < 6; ++channel) {
    const std::vector<Deviations> all = of_all(residuals, runs, channel);
    const double level = robust_level(all);
    if (!(level > 0.0) || count_of(all) < limits.min_tail_readings) continue;
    if (!are_independent(all, level)) continue;
    std::vector<std::vector<char>> in_burst(all.size());
    size_t found = 0;
    for (size_t run = 0; run < all.size(); ++run) {
      const Deviations& d = all[run];
      in_burst[run].assign(d.count(), 0);
      const auto is_far = [&](size_t i) {
        return std::abs(d.size[i]) > limits.burst_sigma * level;
      };
      for (size_t i = 0; i + limits.burst_readings <= d.count(); ++i) {
        size_t far = 0;
        for (size_t j = i; j < i + limits.burst_readings; ++j) far += is_far(j) ? 1 : 0;
        if (2 * far <= limits.burst_readings) continue;
        std::fill_n(in_burst[run].begin() + static_cast<std::ptrdiff_t>(i), limits.burst_readings,
                    1);
      }
      found += static_cast<size_t>(std::count(in_burst[run].begin(), in_burst[run].end(), 1));
    }
    // With a larger fraction, the readings are not isolated faults.
    if (static_cast<double>(found) >
        limits.max_burst_fraction * static_cast<double>(count_of(all))) {
      continue;
    }
    for (size_t run = 0; run < all.size(); ++run) {
      for (size_t i = 0; i < all[run].count(); ++i) {
        if (in_burst[run][i] == 0) continue;
        ++dropped;
        runs[run].rows_in(all[run].block[i], channel) = 0.0;
      }
    }
  }
  return dropped;
}

}  // namespace photorque
