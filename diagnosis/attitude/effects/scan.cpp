#include "diagnosis/attitude/effects/scan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/linear.h"

namespace photorque {

namespace {

double last_reading_s(const std::vector<Observation>& runs) {
  double end = 0.0;
  for (const Observation& seen : runs) end = std::max(end, seen.time_s.back());
  return end;
}

// Power at even frequencies from 0, normalised to 1 for the noise of each channel.
struct ResidualSpectrum {
  double step_Hz = 0.0;
  std::vector<double> power;
};

// Adds the power of one channel of a run (NaN: not read). Readings are binned to a quarter of a
// block, with phase errors below 0.4 rad. Frequencies above half of the channel's sampling rate are
// omitted, because they contain only aliases.
void add_power(const std::vector<double>& white, const Observation& seen,
               ResidualSpectrum& spectrum) {
  const size_t bins = 2 * spectrum.power.size();
  const double bin_s = 1.0 / (spectrum.step_Hz * static_cast<double>(bins));
  std::vector<double> binned(bins, 0.0);
  size_t count = 0;
  for (size_t i = 0; i < white.size(); ++i) {
    if (!std::isfinite(white[i])) continue;
    const double bins_since = (seen.time_s[i] - seen.time_s.front()) / bin_s;
    const auto bin = static_cast<size_t>(std::lround(bins_since));
    binned[std::min(bin, bins - 1)] += white[i];
    ++count;
  }
  if (count < 2) return;
  std::vector<std::complex<double>> transform;
  Eigen::FFT<double> fft;
  fft.fwd(transform, binned);
  const double half_rate_Hz = 0.5 * static_cast<double>(count - 1) / seen.duration_s();
  const auto mirrored = static_cast<size_t>(half_rate_Hz / spectrum.step_Hz);
  for (size_t i = 0; i < std::min(mirrored, spectrum.power.size()); ++i) {
    spectrum.power[i] += std::norm(transform[i]) / static_cast<double>(count);
  }
}

// Adds all channels of one run. Gyro readings count in body axes and in lab axes: an external
// vibration has one frequency in lab axes, which a rotating platform splits.
void add_power(const Prediction& prediction, const Observation& seen, ResidualSpectrum& spectrum) {
  std::array<std::vector<double>, 9> channels;
  for (size_t i = 0; i < prediction.residual.size(); ++i) {
    const WhiteRow& white = prediction.residual[i];
    const Vec3 lab = prediction.states[i].lab_from_body * Vec3(white.segment<3>(3));
    for (Eigen::Index k = 0; k < 6; ++k) channels[static_cast<size_t>(k)].push_back(white[k]);
    for (Eigen::Index k = 0; k < 3; ++k) channels[static_cast<size_t>(6 + k)].push_back(lab[k]);
  }
  for (const std::vector<double>& channel : channels) add_power(channel, seen, spectrum);
}

// The key that requires no search: the strength of a jump or an oscillation.
const std::string& strength_of(const Candidate& c) {
  const std::vector<EffectKey>& keys = c.effect.keys;
  const auto found = std::ranges::find_if(keys, [](const EffectKey& k) { return !k.searched; });
  if (found == keys.end()) throw NumericalError(c.name + " has no strength");
  return found->key;
}

// Number of cycles of the predicted motion in its first run: turns of the body, or oscillations of
// a component of its rate about the mean.
double cycles(const Fit& fit, const Observation& seen) {
  const Prediction p = residuals_of(fit, 0, seen);
  Vec3 mean = Vec3::Zero();
  for (const PlatformState& state : p.states) mean += state.rate_body_rad_s;
  mean /= static_cast<double>(p.states.size());
  double turned_rad = 0.0;
  std::array<double, 3> crossings{};
  for (size_t i = 1; i < p.states.size(); ++i) {
    const Vec3 &before = p.states[i - 1].rate_body_rad_s, &after = p.states[i].rate_body_rad_s;
    turned_rad += 0.5 * (before + after).norm() * (seen.time_s[i] - seen.time_s[i - 1]);
    for (Eigen::Index k = 0; k < 3; ++k) {
      const bool crosses = (before[k] < mean[k]) != (after[k] < mean[k]);
      crossings[static_cast<size_t>(k)] += crosses ? 1.0 : 0.0;
    }
  }
  return std::max(turned_rad / (2.0 * pi), 0.5 * std::ranges::max(crossings));
}

// Starts of an effect that begins at an instant: the grid points of largest gain. A periodic motion
// gives a maximum of the gain in each cycle, and a fit does not leave its maximum. The grid
// therefore has several instants per cycle.
std::vector<Start> instant_starts(const Candidate& c, const Trial& parent,
                                  const std::vector<Observation>& runs,
                                  const Thresholds::Scoring& limits) {
  constexpr double least = 30.0, most = 240.0, per_cycle = 6.0;
  const auto count =
      static_cast<size_t>(std::clamp(per_cycle * cycles(parent.fit, runs.front()), least, most));
  const double last_s = last_reading_s(runs), first_s = runs.front().time_s.front();
  const std::string& strength = strength_of(c);
  std::vector<ScoreGroup> groups;
  for (size_t i = 1; i < count; ++i) {
    const double at_s =
        first_s + (last_s - first_s) * static_cast<double>(i) / static_cast<double>(count);
    groups.push_back({{with_parameter(c.start, "time_s", at_s)}, indices_of(c.start, strength, 3)});
  }
  const std::vector<Score> scores = score(parent.fit, runs, groups);
  std::vector<double> gain;
  for (const Score& s : scores) gain.push_back(s.gain);
  std::vector<Start> starts;
  for (const size_t i : peaks(gain, 2)) {
    if (gain[i] < limits.min_scan_gain) continue;
    Disturbance d = groups[i].disturbances.front();
    if (scores[i].estimate.size() == 3) set_vector(d, strength, scores[i].estimate);
    starts.push_back({d, gain[i]});
  }
  return starts;
}

// Starts of an empirical law: the best value of its exponent or time constant among its starts,
// with coefficients predicted by the score test.
std::vector<Start> empirical_starts(const Candidate& c, const Trial& parent,
                                    const std::vector<Observation>& runs,
                                    const Thresholds::Scoring& limits) {
  const auto own = c.law.shape.first_coefficient();
  const std::vector<int> coefficients =
      indices_of(c.start, empirical_coefficients, c.law.shape.coefficients());
  std::vector<ScoreGroup> groups;
  for (const double value : c.law.starts) {
    groups.push_back({{c.start}, coefficients});
    groups.back().disturbances.front().parameters[own - 1].value = value;
  }
  const std::vector<Score> scores = score(parent.fit, runs, groups);
  const auto best =
      static_cast<size_t>(std::ranges::max_element(scores, {}, &Score::gain) - scores.begin());
  const Eigen::VectorXd& estimate = scores[best].estimate;
  if (scores[best].gain < limits.min_scan_gain) return {};
  if (estimate.size() != static_cast<Eigen::Index>(coefficients.size())) return {};
  Disturbance d = groups[best].disturbances.front();
  for (size_t k = 0; k < coefficients.size(); ++k) {
    d.parameters[own + k].value = estimate[static_cast<Eigen::Index>(k)];
  }
  return {{d, scores[best].gain}};
}

// Below this frequency, sinusoids excite the platform's motion, and the slopes of the whole
// trajectory contain more information than the power of the residual.
double slowest_line_Hz(const std::vector<Observation>& runs) {
  return std::min(0.2, 100.0 / span_s(runs));
}

// Both phases of a tone, with their strengths as parameters.
ScoreGroup sine_and_cosine(const Disturbance& tone, const std::string& strength, double f_Hz) {
  const Disturbance sine = with_parameter(tone, "frequency_Hz", f_Hz);
  return {{sine, with_parameter(sine, "phase", pi / 2)}, indices_of(tone, strength, 3)};
}

// Frequencies below slowest_line_Hz() with the largest gains of a sinusoid of this kind.
std::vector<double> slow_frequencies_Hz(const Disturbance& tone, const std::string& strength,
                                        const Fit& at, const std::vector<Observation>& runs,
                                        const Thresholds::Scoring& limits) {
  constexpr size_t most = 2;
  const double step_Hz = 0.7 / span_s(runs);
  std::vector<double> frequency_Hz;
  std::vector<ScoreGroup> groups;
  for (double f_Hz = step_Hz; f_Hz < slowest_line_Hz(runs); f_Hz += step_Hz) {
    frequency_Hz.push_back(f_Hz);
    groups.push_back(sine_and_cosine(tone, strength, f_Hz));
  }
  std::vector<double> gain;
  for (const Score& s : score(at, runs, groups)) gain.push_back(s.gain);
  std::vector<double> result;
  for (const size_t i : peaks(gain, most)) {
    if (gain[i] > limits.min_scan_gain) result.push_back(frequency_Hz[i]);
  }
  return result;
}

// amplitude · sin(2π f t + φ): sine and cosine are scored as two disturbances with phases 0 and
// π/2; one phase for all axes is the best matrix of rank one.
std::vector<Start> sinusoid_starts(const Candidate& c, const Trial& parent,
                                   const std::vector<Observation>& runs,
                                   const std::vector<Observation>& slow_runs,
                                   const std::vector<double>& lines_Hz,
                                   const Thresholds::Scoring& limits) {
  const std::string& strength = strength_of(c);
  std::vector<double> frequencies_Hz =
      slow_frequencies_Hz(c.start, strength, parent.fit, slow_runs, limits);
  frequencies_Hz.insert(frequencies_Hz.end(), lines_Hz.begin(), lines_Hz.end());
  std::vector<ScoreGroup> groups;
  std::vector<Score> scores;
  for (const double f_Hz : frequencies_Hz) {
    groups.push_back(sine_and_cosine(c.start, strength, f_Hz));
    // Scored separately: fast sinusoids would force short integration steps on all groups of a
    // pass.
    scores.push_back(score(parent.fit, runs, {groups.back()}).front());
  }
  double best = 0.0;
  for (const Score& s : scores) best = std::max(best, s.gain);
  std::vector<Start> starts;
  for (size_t i = 0; i < groups.size(); ++i) {
    if (scores[i].estimate.size() != 6) continue;
    if (scores[i].gain < std::max(limits.min_scan_gain, limits.min_line_fraction * best)) continue;
    Eigen::Matrix<double, 3, 2> amplitude;
    amplitude.col(0) = scores[i].estimate.head<3>();
    amplitude.col(1) = scores[i].estimate.tail<3>();
    // The direction of the largest amplitude: the last eigenvector of A Aᵀ.
    const Vec3 along = symmetric_eigen(amplitude * amplitude.transpose()).vectors.col(2);
    const Vec2 parts = amplitude.transpose() * along;
    Disturbance d = groups[i].disturbances.front();
    set_vector(d, strength, parts.norm() * along);
    parameter_of(d, "phase").value = std::atan2(parts.y(), parts.x());
    starts.push_back({d, scores[i].gain});
  }
  return starts;
}

}  // namespace

std::vector<double> line_frequencies_Hz(const Fit& at, const std::vector<Observation>& runs,
                                        const Thresholds::Scoring& limits, size_t most) {
  double interval_s = span_s(runs);
  for (const Observation& seen : runs) {
    interval_s = std::min(interval_s, seen.duration_s() / static_cast<double>(seen.blocks() - 1));
  }
  // Frequency steps of a quarter of a line width, up to where blocks cause aliases.
  constexpr double bins_a_block = 4.0;
  const double bins = 4.0 * bins_a_block * span_s(runs) / interval_s;
  const size_t size = std::bit_ceil(static_cast<size_t>(bins));
  ResidualSpectrum spectrum{bins_a_block / (interval_s * static_cast<double>(size)),
                            std::vector<double>(size / 2, 0.0)};
  try {
    for (size_t run = 0; run < runs.size(); ++run) {
      add_power(residuals_of(at, run, runs[run]), runs[run], spectrum);
    }
  } catch (const NumericalError&) {
    return {};
  }
  std::vector<double>& power = spectrum.power;
  const auto slow =
      std::min(power.size(), static_cast<size_t>(slowest_line_Hz(runs) / spectrum.step_Hz) + 1);
  std::fill(power.begin(), power.begin() + static_cast<std::ptrdiff_t>(slow), 0.0);
  std::vector<double> result;
  for (const size_t i : peaks(power, most)) {
    if (power[i] > limits.min_line_power)
      result.push_back(static_cast<double>(i) * spectrum.step_Hz);
  }
  return result;
}

std::vector<Start> starts_of(const Candidate& candidate, const Trial& parent,
                             const std::vector<Observation>& runs,
                             const std::vector<Observation>& slow_runs,
                             const std::vector<double>& lines_Hz,
                             const Thresholds::Scoring& limits) {
  switch (candidate.effect.how.scan) {
    case Scan::instant:
      return instant_starts(candidate, parent, slow_runs, limits);
    case Scan::frequency:
      return sinusoid_starts(candidate, parent, runs, slow_runs, lines_Hz, limits);
    case Scan::mode:
      return flexible_mode_starts(candidate.start, parent.fit, runs, slow_runs, lines_Hz, limits);
    case Scan::nothing:
      break;
  }
  if (!candidate.law.starts.empty()) return empirical_starts(candidate, parent, slow_runs, limits);
  return {{candidate.start}};
}

}  // namespace photorque
