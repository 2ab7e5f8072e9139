#include "inference/whiteness.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <ranges>

#include "core/numerics/median.h"
#include "core/numerics/root.h"

namespace photorque::inference {
namespace {

// Expected value of reading n: the median of predictions from both sides and from either side. A
// single bad neighbour then has no influence, and a steadily growing residual is no outlier.
double expected(const std::vector<double>& r, size_t n) {
  std::vector<double> predictions;
  const bool left = n >= 1, right = n + 1 < r.size();
  // At an end, the prediction is the neighbour or the line through two neighbours, whichever is
  // nearer: residuals of unmodelled motion diverge there.
  if (!left || !right) {
    const double one = left ? r[n - 1] : r[n + 1], two = left ? r[n - 2] : r[n + 2];
    const double along = 2.0 * one - two;
    return std::abs(r[n] - along) < std::abs(r[n] - one) ? along : one;
  }
  predictions.push_back(0.5 * (r[n - 1] + r[n + 1]));
  if (n >= 2) predictions.push_back(2.0 * r[n - 1] - r[n - 2]);
  if (n + 2 < r.size()) predictions.push_back(2.0 * r[n + 1] - r[n + 2]);
  if (n >= 2 && predictions.size() < 3) predictions.push_back(r[n - 2]);
  if (n + 2 < r.size() && predictions.size() < 3) predictions.push_back(r[n + 2]);
  return upper_median(predictions);
}

// Standard normal deviate that is exceeded with probability p ≤ 1/2.
double deviate_exceeded_with(double p) {
  const auto is_below = [p](double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2) > p; };
  return bisect(0.0, 40.0, is_below, {60}).low;
}

// Fraction of all sign assignments for which the sum of the positive ranks is at most `sum`.
// `doubled_ranks`: twice each rank, which is an integer even where ties have a mean rank.
double fraction_up_to(const std::vector<size_t>& doubled_ranks, double sum) {
  const auto last = static_cast<size_t>(std::lround(2.0 * sum));
  std::vector<double> ways(last + 1, 0.0);
  ways[0] = 1.0;
  for (const size_t rank : doubled_ranks) {
    for (size_t total = last; total >= rank; --total) ways[total] += ways[total - rank];
  }
  return std::ldexp(std::accumulate(ways.begin(), ways.end(), 0.0),
                    -static_cast<int>(doubled_ranks.size()));
}

}  // namespace

Whiteness whiteness(const std::vector<ChannelResiduals>& runs, const Thresholds::Noise& limits) {
  Whiteness result;
  const size_t channels = runs.empty() ? 0 : runs.front().size();
  double sum = 0.0;
  int64_t means = 0;
  for (size_t k = 0; k < channels; ++k) {
    for (const ChannelResiduals& run : runs) {
      const std::vector<double>& r = run[k];
      for (size_t i = 0; i + limits.neighbours <= r.size(); i += limits.neighbours) {
        double mean = 0.0;
        for (size_t j = i; j < i + limits.neighbours; ++j) mean += r[j];
        sum += mean * mean / static_cast<double>(limits.neighbours);
        ++means;
      }
    }
  }
  if (means == 0) return result;
  const double variance = 2.0 / static_cast<double>(means);
  result.slow_chi2_per_mean = sum / static_cast<double>(means);
  result.excess_sigma = (result.slow_chi2_per_mean - 1.0) / std::sqrt(variance);
  return result;
}

double size_excess_sigma(const std::vector<ChannelResiduals>& runs, double most) {
  double chi2 = 0.0, count = 0.0;
  for (const std::vector<double>& channel : runs | std::views::join) {
    for (const double r : channel) chi2 += r * r;
    count += static_cast<double>(channel.size());
  }
  return count > 0.0 ? (chi2 / count - most) / std::sqrt(2.0 / count) : 0.0;
}

std::vector<size_t> outliers(const std::vector<double>& residuals,
                             const Thresholds::Noise& limits) {
  std::vector<size_t> found;
  if (residuals.size() < limits.min_neighbourhood) return found;
  std::vector<double> off;
  for (size_t n = 0; n < residuals.size(); ++n) {
    off.push_back(std::abs(residuals[n] - expected(residuals, n)));
  }
  // If most readings deviate by more than their noise, the cause is unmodelled motion, not
  // outliers.
  const double scatter = std::max(1.0, upper_median(off) / limits.usual_surprise);
  for (size_t n = 0; n < off.size(); ++n) {
    if (off[n] > limits.outlier_sigma * scatter) found.push_back(n);
  }
  return found;
}

double mean_sigma(std::vector<double> differences) {
  if (differences.size() < 3) return 0.0;
  std::vector<double> sizes;
  double largest = 0.0;
  for (const double d : differences) {
    if (std::isfinite(d)) largest = std::max(largest, std::abs(d));
  }
  // An infinite difference, of an explanation that cannot be evaluated, counts as the largest
  // finite one.
  if (largest == 0.0) largest = 1.0;
  for (double& d : differences) {
    d = std::clamp(d, -largest, largest);
    sizes.push_back(std::abs(d));
  }
  const double most = 3.0 * upper_median(std::move(sizes));
  const auto n = static_cast<double>(differences.size());
  double sum = 0.0, squares = 0.0;
  for (double& d : differences) {
    d = std::clamp(d, -most, most);
    sum += d;
    squares += d * d;
  }
  const double mean = sum / n, variance = (squares / n - mean * mean) * n / (n - 1.0);
  if (mean == 0.0) return 0.0;
  const double freedom = n - 1.0, t = mean / std::sqrt(std::max(variance, 1e-300) / n);
  const double normal = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0) *
                        std::sqrt(freedom * std::log1p(t * t / freedom));
  return std::copysign(normal, t);
}

double signed_rank_sigma(const std::vector<double>& differences) {
  std::vector<double> x;
  for (const double d : differences) {
    if (d != 0.0 && !std::isnan(d)) x.push_back(d);
  }
  if (x.empty()) return 0.0;
  std::sort(x.begin(), x.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  double above = 0.0;
  std::vector<size_t> doubled_ranks;
  for (size_t first = 0, last = 0; first < x.size(); first = last) {
    last = first;
    while (last < x.size() && std::abs(x[last]) == std::abs(x[first])) ++last;
    const double rank = 0.5 * static_cast<double>(first + 1 + last);
    for (size_t i = first; i < last; ++i) above += x[i] > 0.0 ? rank : 0.0;
    doubled_ranks.resize(last, first + 1 + last);
  }
  constexpr size_t most_counted = 50;
  const auto n = static_cast<double>(x.size());
  const double off = above - n * (n + 1.0) / 4.0;
  if (x.size() > most_counted) return off / std::sqrt(n * (n + 1.0) * (2.0 * n + 1.0) / 24.0);
  const double fewer = std::min(above, n * (n + 1.0) / 2.0 - above);
  const double tail = std::min(0.5, fraction_up_to(doubled_ranks, fewer));
  return std::copysign(deviate_exceeded_with(tail), off);
}

double gain_sigma(const std::vector<double>& chi2_of_worse,
                  const std::vector<double>& chi2_of_better) {
  std::vector<double> gains;
  for (size_t i = 0; i < chi2_of_worse.size(); ++i) {
    const double gain = 0.5 * (chi2_of_worse[i] - chi2_of_better[i]);
    if (!std::isnan(gain)) gains.push_back(gain);
  }
  const double by_ranks = signed_rank_sigma(gains), by_mean = mean_sigma(std::move(gains));
  return std::abs(by_ranks) > std::abs(by_mean) ? by_ranks : by_mean;
}

}  // namespace photorque::inference
