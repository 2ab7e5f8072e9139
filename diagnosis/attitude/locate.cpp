#include "diagnosis/attitude/findings.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numeric>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/median.h"

namespace photorque {

namespace {

constexpr double median_of_chi2_of_one = 0.454936;  // median of χ² with one degree of freedom

// Fortieths of the run whose mean square significantly exceeds that of noise; adjacent ones are
// merged.
std::vector<Where::Interval> intervals(const Prediction& p, const Observation& seen,
                                       const Thresholds::Location& limits) {
  constexpr size_t windows = 40;
  std::vector<Where::Interval> result;
  const size_t blocks = p.residual.size();
  for (size_t w = 0; w < windows; ++w) {
    const size_t first = w * blocks / windows, last = (w + 1) * blocks / windows;
    double sum = 0.0;
    int64_t count = 0;
    for (size_t i = first; i < last; ++i) {
      for (Eigen::Index k = 0; k < channel_count; ++k) {
        if (!std::isfinite(p.residual[i][k])) continue;
        sum += p.residual[i][k] * p.residual[i][k];
        ++count;
      }
    }
    const double n = static_cast<double>(count);
    if (count < limits.min_readings) continue;
    if (sum < n + limits.interval_sigma * std::sqrt(2.0 * n)) continue;
    const double from_s = seen.time_s[first], to_s = seen.time_s[last - 1];
    const bool touches =
        !result.empty() && w > 0 && result.back().to >= seen.time_s[first == 0 ? 0 : first - 1];
    if (touches) {
      result.back().to = to_s;
    } else {
      result.push_back({from_s, to_s});
    }
  }
  return result;
}

// The band with nearly all of the power in excess of noise.
std::optional<Where::Interval> band(const Prediction& p, const Observation& seen,
                                    const Thresholds::Location& limits) {
  constexpr size_t max_lines = 400;
  const double step_Hz = 0.5 / seen.duration_s();
  const double highest_Hz = 0.5 * static_cast<double>(seen.blocks()) / seen.duration_s();
  const auto lines = std::min(max_lines, static_cast<size_t>(highest_Hz / step_Hz));
  std::vector<double> excess(lines, 0.0);
  double total = 0.0;
  for (size_t l = 0; l < lines; ++l) {
    for (Eigen::Index k = 0; k < channel_count; ++k) {
      std::complex<double> sum = 0.0;
      double count = 0.0;
      for (size_t i = 0; i < p.residual.size(); ++i) {
        if (!std::isfinite(p.residual[i][k])) continue;
        const double angle = 2.0 * pi * step_Hz * static_cast<double>(l) * seen.time_s[i];
        sum += p.residual[i][k] * std::polar(1.0, angle);
        count += 1.0;
      }
      if (count > 0.0) excess[l] += std::max(0.0, std::norm(sum) / count - limits.noise_power);
    }
    total += excess[l];
  }
  if (!(total > limits.min_band_power)) return std::nullopt;
  double below = 0.0;
  size_t low = 0, high = 0;
  for (size_t l = 0; l < lines; ++l) {
    below += excess[l];
    if (below < limits.band_edge * total) low = l;
    if (below < (1.0 - limits.band_edge) * total) high = l + 1;
  }
  return Where::Interval{step_Hz * static_cast<double>(low), step_Hz * static_cast<double>(high)};
}

}  // namespace

std::vector<Where::ChannelMisfit> misfits(const std::vector<Prediction>& residuals) {
  std::vector<Where::ChannelMisfit> result;
  for (Eigen::Index k = 0; k < channel_count; ++k) {
    std::vector<double> squares;
    for (const Prediction& p : residuals) {
      for (const WhiteRow& row : p.residual) {
        if (std::isfinite(row[k])) squares.push_back(row[k] * row[k]);
      }
    }
    if (squares.empty()) continue;
    const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
    const auto count = static_cast<double>(squares.size());
    result.push_back({channel_traits(static_cast<int>(k)).name, sum / count,
                      upper_median(std::move(squares)) / median_of_chi2_of_one});
  }
  std::ranges::stable_sort(result, std::greater(), &Where::ChannelMisfit::chi2_per_sample);
  return result;
}

Where locate(const Fit& nominal, const std::vector<Observation>& runs,
             const Thresholds::Location& limits) {
  try {
    const std::vector<Prediction> residuals = residuals_of(nominal, runs);
    return {misfits(residuals),
            intervals(residuals.front(), runs.front(), limits),
            band(residuals.front(), runs.front(), limits),
            {}};
  } catch (const NumericalError&) {
    return {};
  }
}

std::vector<Where::Dependence> dependences(const std::vector<Trial>& trials,
                                           const Candidates& all) {
  const double nominal = trials.front().log_evidence;
  double most = nominal;
  for (const Trial& t : trials) most = std::max(most, t.log_evidence);
  std::map<std::string, double> strength;
  for (const Trial& t : trials) {
    if (t.candidates.size() != 1 || !all[t.candidates[0]].is_empirical) continue;
    const double fraction = (t.log_evidence - nominal) / std::max(1.0, most - nominal);
    double& best = strength[all[t.candidates[0]].variable];
    best = std::max(best, std::clamp(fraction, 0.0, 1.0));
  }
  std::vector<Where::Dependence> result;
  for (const auto& [variable, fraction] : strength) {
    if (fraction > all.limits.location.min_dependence) result.push_back({variable, fraction});
  }
  std::ranges::stable_sort(result, std::greater(), &Where::Dependence::strength);
  return result;
}

std::vector<Where::Dependence> of_unknown_law(std::vector<Where::Dependence> depends_on,
                                              const Trial& chosen, const Candidates& all) {
  for (const size_t c : chosen.candidates) {
    if (!all[c].is_empirical) continue;
    const auto known = std::find_if(depends_on.begin(), depends_on.end(),
                                    [&](const auto& d) { return d.variable == all[c].variable; });
    if (known == depends_on.end()) {
      depends_on.insert(depends_on.begin(), {all[c].variable, 0.0});
    } else {
      std::rotate(depends_on.begin(), known, known + 1);
    }
  }
  // A torque that depends on no state of the platform is reported as a function of time.
  if (depends_on.empty()) depends_on.push_back({"time", 0.0});
  return depends_on;
}

}  // namespace photorque
