#include "diagnosis/scan.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "core/constants.h"
#include "core/errors.h"
#include "diagnosis/averaging.h"
#include "diagnosis/screen.h"

namespace photorque {
namespace {

// Of a scan's peak, to be worth a fit: chance alone reaches less in most scans.
constexpr double least_gain = 14.0;

double end_s(const std::vector<Observation>& runs) {
  double end = 0.0;
  for (const Observation& seen : runs) end = std::max(end, seen.time_s.back());
  return end;
}

// From the first reading to the last: of several recordings the longest, of the pieces of one all
// of it. What acts at one frequency keeps its phase from piece to piece.
double span_s(const std::vector<Observation>& runs) {
  double start_s = runs.front().time_s.front();
  for (const Observation& seen : runs) start_s = std::min(start_s, seen.time_s.front());
  return end_s(runs) - start_s;
}

// Indices of the `most` largest values that are larger than both neighbours.
std::vector<size_t> peaks(const std::vector<double>& value, size_t most) {
  std::vector<size_t> found;
  for (size_t i = 0; i < value.size(); ++i) {
    const bool rises = i == 0 || value[i] >= value[i - 1];
    const bool falls = i + 1 == value.size() || value[i] > value[i + 1];
    if (rises && falls) found.push_back(i);
  }
  std::sort(found.begin(), found.end(), [&](size_t a, size_t b) { return value[a] > value[b]; });
  if (found.size() > most) found.resize(most);
  return found;
}

// Power of the whitened residuals of all channels of one run on an even grid of frequencies. The
// gyro counts in body axes and, turned, in lab axes: what shakes from outside has its one frequency
// there, while a platform that turns sees it split.
void add_power(const Prediction& prediction, const Observation& seen, double step_Hz,
               std::vector<double>& power) {
  const size_t blocks = prediction.residual.size();
  std::vector<std::complex<double>> phasor(blocks, 1.0), turn(blocks);
  for (size_t i = 0; i < blocks; ++i) {
    turn[i] = std::polar(1.0, 2.0 * pi * step_Hz * seen.time_s[i]);
  }
  constexpr size_t channels = 9;
  std::array<std::vector<double>, channels> channel;
  for (size_t i = 0; i < blocks; ++i) {
    const WhiteRow white =
        prediction.residual[i].unaryExpr([](double r) { return std::isfinite(r) ? r : 0.0; });
    const Vec3 lab = prediction.states[i].lab_from_body * Vec3(white.tail<3>());
    for (Eigen::Index k = 0; k < 6; ++k) channel[static_cast<size_t>(k)].push_back(white[k]);
    for (Eigen::Index k = 0; k < 3; ++k) channel[static_cast<size_t>(6 + k)].push_back(lab[k]);
  }
  for (double& at : power) {
    std::array<std::complex<double>, channels> sum{};
    for (size_t i = 0; i < blocks; ++i) {
      phasor[i] *= turn[i];
      for (size_t k = 0; k < channels; ++k) sum[k] += channel[k][i] * phasor[i];
    }
    for (const auto& s : sum) at += std::norm(s) / static_cast<double>(blocks);
  }
}

Disturbance with(const Disturbance& like, size_t parameter, double value) {
  Disturbance d = like;
  d.parameters[parameter].value = value;
  return d;
}

// The jump in the centre of mass at each of a grid of instants.
std::vector<Disturbance> mass_shift_starts(const Candidate& c, const Trial& parent,
                                           const std::vector<Observation>& runs) {
  constexpr size_t count = 30;
  const double last_s = end_s(runs), first_s = runs.front().time_s.front();
  std::vector<ScoreGroup> groups;
  for (size_t i = 1; i < count; ++i) {
    const double at_s = first_s + (last_s - first_s) * static_cast<double>(i) / count;
    groups.push_back({{with(c.start, 0, at_s)}, {1, 2, 3}});
  }
  const std::vector<Score> scores = score(parent.fit, runs, groups);
  std::vector<double> gain;
  for (const Score& s : scores) gain.push_back(s.gain);
  std::vector<Disturbance> starts;
  for (const size_t i : peaks(gain, 2)) {
    if (gain[i] < least_gain) continue;
    Disturbance d = groups[i].disturbances.front();
    for (Eigen::Index k = 0; k < scores[i].estimate.size() && k < 3; ++k) {
      d.parameters[static_cast<size_t>(1 + k)].value = scores[i].estimate[k];
    }
    starts.push_back(d);
  }
  return starts;
}

// amplitude · sin(2π f t + φ): sine and cosine are scored as two disturbances with phases 0 and
// π/2; one phase for all axes is the best matrix of rank one.
std::vector<Disturbance> sinusoid_starts(const Candidate& c, const Trial& parent,
                                         const std::vector<Observation>& runs,
                                         const std::vector<double>& frequencies_Hz) {
  std::vector<ScoreGroup> groups;
  std::vector<Score> scores;
  for (const double f_Hz : frequencies_Hz) {
    const Disturbance sine = with(c.start, 3, f_Hz);
    groups.push_back({{sine, with(sine, 4, pi / 2)}, {0, 1, 2}});
    // Each alone: fast ones make short steps for all that share their pass.
    scores.push_back(score(parent.fit, runs, {groups.back()}).front());
  }
  double best = 0.0;
  for (const Score& s : scores) best = std::max(best, s.gain);
  std::vector<Disturbance> starts;
  for (size_t i = 0; i < groups.size(); ++i) {
    constexpr double least_share = 0.1;
    if (scores[i].estimate.size() != 6) continue;
    if (scores[i].gain < std::max(least_gain, least_share * best)) continue;
    Eigen::Matrix<double, 3, 2> amplitude;
    amplitude.col(0) = scores[i].estimate.head<3>();
    amplitude.col(1) = scores[i].estimate.tail<3>();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(amplitude,
                                                Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Vec3 vector = svd.singularValues()[0] * svd.matrixU().col(0);
    Disturbance d = groups[i].disturbances.front();
    for (int k = 0; k < 3; ++k) d.parameters[static_cast<size_t>(k)].value = vector[k];
    d.parameters[4].value = std::atan2(svd.matrixV()(1, 0), svd.matrixV()(0, 0));
    starts.push_back(d);
  }
  return starts;
}

// The runs in blocks so short that a swing at this frequency passes through many of them.
std::vector<Observation> as_fine_as(double frequency_Hz, const Fit& at,
                                    const std::vector<Observation>& runs) {
  constexpr double blocks_a_swing = 7.0;
  const double blocks = blocks_a_swing * frequency_Hz * runs.front().duration_s();
  if (blocks > static_cast<double>(runs.front().blocks())) return runs;
  return averaged_about(at, runs, static_cast<size_t>(blocks));
}

// Light appendages of one frequency about six axes: their matrices J a aᵀ span the symmetric ones.
ScoreGroup appendages(const Disturbance& start, double frequency_Hz) {
  // Mostly short pulls set them swinging (a command that begins or ends), so that a resonance looks
  // as wide as its damping: enough of it for the grid of frequencies.
  constexpr double damping = 0.08;
  ScoreGroup group;
  group.parameters = {5};
  for (const Vec3& axis :
       {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 0), Vec3(1, 0, 1), Vec3(0, 1, 1)}) {
    Disturbance d = with(with(start, 3, frequency_Hz), 4, damping);
    const Vec3 unit = axis.normalized();
    for (int k = 0; k < 3; ++k) d.parameters[static_cast<size_t>(k)].value = unit[k];
    d.states[1].per_body_rate = unit;
    d.parameters[5].value *= 1e-3;
    group.disturbances.push_back(std::move(d));
  }
  return group;
}

// As the strengths of six appendages(): the one about `axis`.
Eigen::VectorXd as_six(const Vec3& axis) {
  const Mat3 M = axis * axis.transpose();
  Eigen::VectorXd six(6);
  six << M(0, 0) - M(0, 1) - M(0, 2), M(1, 1) - M(0, 1) - M(1, 2), M(2, 2) - M(0, 2) - M(1, 2),
      2.0 * M(0, 1), 2.0 * M(0, 2), 2.0 * M(1, 2);
  return six;
}

struct Mode {
  double gain = 0.0;  // expected fall of χ²
  Disturbance start;
};

// The one appendage that does most of what the six would together: about an eigenvector of
// Σ J a aᵀ.
Mode best_appendage(const ScoreGroup& group, const Score& score, const Mat3& inertia_kg_m2) {
  Mode best;
  if (score.estimate.size() != 6) return best;
  Mat3 sum = Mat3::Zero();
  for (size_t i = 0; i < 6; ++i) {
    const Vec3& axis = group.disturbances[i].states[1].per_body_rate;
    sum += score.estimate[static_cast<Eigen::Index>(i)] * axis * axis.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(sum);
  for (int e = 0; e < 3; ++e) {
    const Vec3 axis = eigen.eigenvectors().col(e);
    const Eigen::VectorXd six = as_six(axis);
    const double along = six.dot(score.information * score.estimate);
    const double curvature = six.dot(score.information * six);
    if (!(along > 0.0) || along * along < best.gain * curvature) continue;
    best.gain = along * along / curvature;
    const double whole_kg_m2 = axis.dot(inertia_kg_m2 * axis);
    const double share = std::min(along / curvature / whole_kg_m2, 0.5);
    best.start = group.disturbances.front();
    auto& parameters = best.start.parameters;
    for (int k = 0; k < 3; ++k) parameters[static_cast<size_t>(k)].value = axis[k];
    best.start.states[1].per_body_rate = axis;
    // The platform's recoil makes a heavy appendage swing faster than with the platform held.
    parameters[3].value *= std::sqrt(1.0 - share);
    parameters[4].value = 0.04;
    parameters[5].value = share * whole_kg_m2;
  }
  return best;
}

std::vector<Disturbance> flexible_mode_starts(const Candidate& c, const Trial& parent,
                                              const std::vector<Observation>& runs,
                                              const std::vector<Observation>& slow_runs) {
  constexpr double step = 1.2, most_Hz = 5.0;
  constexpr size_t most_starts = 3;
  const auto interval_s = [](const Observation& seen) {
    return seen.duration_s() / static_cast<double>(seen.blocks());
  };
  const double highest_Hz = std::min(most_Hz, 0.4 / interval_s(runs.front()));
  const double slow_Hz = 0.14 / interval_s(slow_runs.front());
  std::vector<Mode> modes;
  std::vector<double> gain;
  for (double f_Hz = std::max(0.02, 2.0 / span_s(runs)); f_Hz < highest_Hz; f_Hz *= step) {
    const ScoreGroup group = appendages(c.start, f_Hz);
    const bool slow = f_Hz < slow_Hz;
    const Score together =
        score(parent.fit, slow ? slow_runs : as_fine_as(f_Hz, parent.fit, runs), {group}).front();
    modes.push_back(best_appendage(group, together, parent.fit.best.model.platform.inertia_kg_m2));
    gain.push_back(modes.back().gain);
  }
  std::vector<Disturbance> starts;
  for (const size_t i : peaks(gain, most_starts)) {
    if (gain[i] > least_gain) starts.push_back(modes[i].start);
  }
  return starts;
}

// Slow sinusoids excite the platform's own motion; there the slopes of the whole trajectory tell
// more than the residual's power.
std::vector<double> slow_frequencies_Hz(const Fit& at, const std::vector<Observation>& runs,
                                        double highest_Hz, size_t most) {
  const double step_Hz = 0.7 / span_s(runs);
  std::vector<double> frequency_Hz;
  std::vector<ScoreGroup> groups;
  const Effect effect{
      "periodic_torque", {{"torque_N_m", {0, 0, 0}}, {"frequency_Hz", {1}}, {"phase", {0}}}, ""};
  const DisturbanceContext context{at.best.model.platform, at.best.model.environment};
  const Disturbance tone = disturbance_of(effect, context);
  for (double f_Hz = step_Hz; f_Hz < highest_Hz; f_Hz += step_Hz) {
    frequency_Hz.push_back(f_Hz);
    const Disturbance sine = with(tone, 3, f_Hz);
    groups.push_back({{sine, with(sine, 4, pi / 2)}, {0, 1, 2}});
  }
  std::vector<double> gain;
  for (const Score& s : score(at, runs, groups)) gain.push_back(s.gain);
  std::vector<double> result;
  for (const size_t i : peaks(gain, most)) {
    if (gain[i] > least_gain) result.push_back(frequency_Hz[i]);
  }
  return result;
}

}  // namespace

std::vector<double> line_frequencies_Hz(const Fit& at, const std::vector<Observation>& runs,
                                        const std::vector<Observation>& slow_runs, size_t most) {
  const double step_Hz = 0.25 / span_s(runs);
  double interval_s = span_s(runs);
  for (const Observation& seen : runs) {
    interval_s = std::min(interval_s, seen.duration_s() / static_cast<double>(seen.blocks() - 1));
  }
  const double slow_Hz = std::min(0.2, 100.0 / span_s(runs));
  std::vector<double> power(static_cast<size_t>(0.5 / interval_s / step_Hz), 0.0);
  PredictionOptions options;
  options.keep_residuals = true;
  for (size_t run = 0; run < runs.size(); ++run) {
    const Dynamics dynamics(at.best.model_of(run, runs[run]));
    try {
      add_power(predict(dynamics, at.best.runs[run].initial, runs[run], {}, options), runs[run],
                step_Hz, power);
    } catch (const NumericalError&) {
      return {};
    }
  }
  std::vector<double> result = slow_frequencies_Hz(at, slow_runs, slow_Hz, most / 2);
  const auto slow = std::min(power.size(), static_cast<size_t>(slow_Hz / step_Hz));
  std::fill(power.begin(), power.begin() + static_cast<std::ptrdiff_t>(slow), 0.0);
  for (const size_t i : peaks(power, most)) {
    // Power 1 for each of nine channels is noise; the largest of thousands stays below this.
    if (power[i] > 30.0) result.push_back(static_cast<double>(i + 1) * step_Hz);
  }
  return result;
}

std::vector<Disturbance> starts_of(const Candidate& candidate, const Trial& parent,
                                   const std::vector<Observation>& runs,
                                   const std::vector<Observation>& slow_runs,
                                   const std::vector<double>& lines_Hz) {
  const std::string& kind = candidate.effect.kind;
  if (kind == "mass_shift") return mass_shift_starts(candidate, parent, slow_runs);
  if (kind == "periodic_torque" || kind == "floor_vibration") {
    return sinusoid_starts(candidate, parent, runs, lines_Hz);
  }
  if (kind == "flexible_mode") return flexible_mode_starts(candidate, parent, runs, slow_runs);
  return {candidate.start};
}

}  // namespace photorque
