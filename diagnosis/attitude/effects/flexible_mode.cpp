// Flexible appendages: screening, and starts for their frequency and axis.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "attitude/estimation/fit.h"
#include "attitude/observation/prediction.h"
#include "core/constants.h"
#include "diagnosis/attitude/effects/scan.h"

namespace photorque {
namespace {

// State of oscillators about the three body axes, relative to the body.
struct Swing {
  Vec3 angle_rad = Vec3::Zero(), rate_rad_s = Vec3::Zero();
};

// Solves φ'' + 2 ζ ω φ' + ω² φ = −dω_body/dt, starting at rest relative to the body. The
// acceleration is constant between readings, so the solution is exact for uneven times.
std::vector<Swing> swings(const PropagatedRun& run, double frequency_Hz, double damping) {
  const double angular_frequency = 2.0 * pi * frequency_Hz;
  const double decay = damping * angular_frequency;
  const double swing_angular_frequency = angular_frequency * std::sqrt(1.0 - damping * damping);
  const std::vector<PlatformState>& states = run.propagated.states;
  std::vector<Swing> result(states.size());
  for (size_t i = 1; i < states.size(); ++i) {
    const double h_s = run.seen.time_s[i] - run.seen.time_s[i - 1];
    const Vec3 push = (states[i - 1].rate_body_rad_s - states[i].rate_body_rad_s) / h_s;
    const Vec3 rest = push / (angular_frequency * angular_frequency);
    const Vec3 off = result[i - 1].angle_rad - rest;
    const Vec3 sine = (result[i - 1].rate_rad_s + decay * off) / swing_angular_frequency;
    const double shrunk = std::exp(-decay * h_s);
    const double c = shrunk * std::cos(swing_angular_frequency * h_s);
    const double s = shrunk * std::sin(swing_angular_frequency * h_s);
    const Vec3 angle = c * off + s * sine;
    result[i].angle_rad = rest + angle;
    result[i].rate_rad_s = swing_angular_frequency * (c * sine - s * off) - decay * angle;
  }
  return result;
}

// Subtracts the moving average over `window` neighbours (odd) from every row.
void subtract_moving_average(Eigen::MatrixXd& rows, Eigen::Index window) {
  const Eigen::Index n = rows.rows(), half = window / 2;
  Eigen::MatrixXd until(n + 1, rows.cols());  // sums of the preceding rows
  until.row(0).setZero();
  for (Eigen::Index i = 0; i < n; ++i) until.row(i + 1) = until.row(i) + rows.row(i);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index first = std::max<Eigen::Index>(0, i - half);
    const Eigen::Index last = std::min(n, i + half + 1);
    rows.row(i) -= (until.row(last) - until.row(first)) / static_cast<double>(last - first);
  }
}

// Rows of one channel at its readings: the whitened response to each appendage, then the residual.
Eigen::MatrixXd answers(const PropagatedRun& run, const std::vector<Swing>& swing,
                        const std::vector<Vec3>& axes, const std::vector<Vec3>& answer_body,
                        Eigen::Index channel) {
  const auto count = static_cast<Eigen::Index>(axes.size());
  const Observation& seen = run.seen;
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(seen.blocks()), count + 1);
  Eigen::Index used = 0;
  Whitening whitening(seen, static_cast<int>(channel), count);
  for (size_t i = 0; i < seen.blocks(); ++i) {
    const bool camera = channel < 3;
    const Eigen::Index k = channel % 3;
    const double readings = seen.rows_of(i, static_cast<int>(channel));
    if (!(readings > 0.0)) continue;
    const Vec3& moved = camera ? swing[i].angle_rad : swing[i].rate_rad_s;
    const Vec3 unit = Vec3::Unit(k);
    const Vec3 along =
        camera ? Vec3(run.propagated.states[i].lab_from_body.conjugate() * unit) : unit;
    for (Eigen::Index a = 0; a < count; ++a) {
      const auto at = static_cast<size_t>(a);
      rows(used, a) = along.dot(answer_body[at]) * axes[at].dot(moved);
    }
    whitening.apply(seen.time_s[i], readings, rows.row(used).head(count));
    rows(used++, count) = run.propagated.residual[i][channel];
  }
  return rows.topRows(used);
}

// Sums of products of the responses and the residual of one run, without parts slower than a swing.
Eigen::MatrixXd sums_of(const PropagatedRun& run, const std::vector<Swing>& swing,
                        const std::vector<Vec3>& axes, const std::vector<Vec3>& answer_body,
                        double frequency_Hz) {
  const auto count = static_cast<Eigen::Index>(axes.size());
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(count + 1, count + 1);
  for (Eigen::Index channel = 0; channel < 6; ++channel) {
    Eigen::MatrixXd rows = answers(run, swing, axes, answer_body, channel);
    if (rows.rows() == 0) continue;
    const double a_second = static_cast<double>(rows.rows()) / run.seen.duration_s();
    const auto half = static_cast<Eigen::Index>(0.5 * a_second / frequency_Hz);
    subtract_moving_average(rows, 2 * std::max<Eigen::Index>(1, half) + 1);
    sums += rows.transpose() * rows;
  }
  return sums;
}

// The score of the strengths whose responses the sums contain.
Score score_of(const Eigen::MatrixXd& sums) {
  const Eigen::Index count = sums.rows() - 1;
  return solve_score(sums.topLeftCorner(count, count), sums.col(count).head(count),
                     sums.diagonal().head(count));
}

// Appendages are mostly excited by short pulses (the start or end of a command), so the width of a
// resonance is given by its damping. This damping makes it wide enough for the frequency grid.
constexpr double scanned_damping = 0.08;

// The appendage initially rotates with the body. Its rate is the body rate about its axis.
void set_axis(Disturbance& d, const Vec3& unit) {
  set_vector(d, "axis", unit);
  state_of(d, "rate_rad_s").per_body_rate = unit;
}

// Light appendages of one frequency about six axes: their matrices J a aᵀ span all symmetric
// matrices.
ScoreGroup appendages(const Disturbance& start, double frequency_Hz,
                      double damping = scanned_damping) {
  ScoreGroup group;
  group.parameters = {static_cast<int>(index_of(start, "inertia_kg_m2"))};
  for (const Vec3& axis :
       {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 0), Vec3(1, 0, 1), Vec3(0, 1, 1)}) {
    Disturbance d = with_parameter(start, "frequency_Hz", frequency_Hz);
    parameter_of(d, "damping").value = damping;
    parameter_of(d, "inertia_kg_m2").value *= 1e-3;
    set_axis(d, axis.normalized());
    group.disturbances.push_back(std::move(d));
  }
  return group;
}

std::vector<Vec3> axes_of(const ScoreGroup& group) {
  std::vector<Vec3> axes;
  for (const Disturbance& d : group.disturbances) axes.push_back(vector_of(d, "axis"));
  return axes;
}

// Strengths of the six appendages() that are equivalent to one about `axis`.
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
  double scanned_Hz = 0.0;
};

// Converts a scored strength about `axis`, which neglects the recoil on the platform, into an
// appendage with recoil. With μ = J aᵀI⁻¹a, an appendage of frequency f swings at f/√(1 − μ),
// driven by 1/(1 − μ) times the acceleration. The score therefore finds J/(1 − μ) at f/√(1 − μ).
Disturbance heavy(const Disturbance& light, const Vec3& axis, double strength_kg_m2,
                  const Mat3& inertia_kg_m2) {
  constexpr double most = 0.5;
  const double scored = strength_kg_m2 * axis.dot(inertia_kg_m2.inverse() * axis);
  const double fraction = std::min(scored / (1.0 + scored), most);
  Disturbance d = light;
  set_axis(d, axis);
  parameter_of(d, "frequency_Hz").value *= std::sqrt(1.0 - fraction);
  parameter_of(d, "damping").value *= std::sqrt(1.0 - fraction);
  parameter_of(d, "inertia_kg_m2").value = fraction / axis.dot(inertia_kg_m2.inverse() * axis);
  return d;
}

// The single appendage with the largest gain, about an eigenvector of Σ J a aᵀ over all six.
Mode best_appendage(const ScoreGroup& group, const Score& score, const Mat3& inertia_kg_m2) {
  Mode best;
  if (score.estimate.size() != 6) return best;
  Mat3 sum = Mat3::Zero();
  for (size_t i = 0; i < 6; ++i) {
    const Vec3 axis = vector_of(group.disturbances[i], "axis");
    sum += score.estimate[static_cast<Eigen::Index>(i)] * axis * axis.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(sum);
  for (int e = 0; e < 3; ++e) {
    const Vec3 axis = eigen.eigenvectors().col(e);
    const Eigen::VectorXd six = as_six(axis);
    const double along = six.dot(score.information * score.estimate);
    const double curvature = six.dot(score.information * six);
    if (!(along > 0.0 && curvature > 0.0)) continue;
    if (along * along < best.gain * curvature) continue;
    best.gain = along * along / curvature;
    best.start = heavy(group.disturbances.front(), axis, along / curvature, inertia_kg_m2);
  }
  return best;
}

// Combines two scores of the same parameters from independent readings: their informations add.
Score together(const Score& a, const Score& b) {
  if (a.estimate.size() != b.estimate.size()) return b;
  const Eigen::MatrixXd information = a.information + b.information;
  const Eigen::VectorXd gradient = a.information * a.estimate + b.information * b.estimate;
  return solve_score(information, gradient, information.diagonal());
}

// Score of appendages that swing far faster than the platform moves, extrapolated from the score at
// another such frequency. The appendage adds a constant part to the inertia, which is independent
// of frequency, and the torque −J a (a·ω)''/(2πf)².
Score carried_at(const Score& carried, double scored_Hz, double frequency_Hz) {
  const double grows = scored_Hz * scored_Hz / (frequency_Hz * frequency_Hz);
  Score at = carried;
  at.estimate /= grows;
  at.information *= grows * grows;
  return at;
}

struct Tuned {
  double frequency_Hz = 0.0, damping = scanned_damping;
  Score ringing;
};

// Frequency and damping near `frequency_Hz` with the largest gain of ringing. A weakly damped
// appendage stays in phase only at the right frequency: a fit that starts farther off ends in
// another local minimum.
Tuned tuned(const std::vector<PropagatedRun>& runs, const Mat3& inertia_kg_m2,
            const std::vector<Vec3>& axes, double frequency_Hz) {
  constexpr double first_reach = 0.1, least_damping = 0.004;
  constexpr int steps = 2;
  Tuned best{frequency_Hz, scanned_damping,
             score_of_ringing(runs, inertia_kg_m2, axes, frequency_Hz, scanned_damping)};
  double reach = first_reach;
  // The frequency steps remain about as wide as the resonance.
  for (double damping = 0.5 * scanned_damping; damping > least_damping; damping *= 0.5) {
    const double centre_Hz = best.frequency_Hz;
    for (int k = -steps; k <= steps; ++k) {
      const double f_Hz = centre_Hz * (1.0 + reach * k / steps);
      Score ringing = score_of_ringing(runs, inertia_kg_m2, axes, f_Hz, damping);
      if (ringing.gain > best.ringing.gain) best = {f_Hz, damping, std::move(ringing)};
    }
    reach *= 0.5;
  }
  return best;
}

// Free swings of an appendage that was deflected at the start of a run: the body swings against it
// along −I⁻¹ a. Angle and rate of a unit swing: cosine (x) and sine (y).
std::vector<Swing> free_swings(const PropagatedRun& run, double frequency_Hz, double damping) {
  const double angular_frequency = 2.0 * pi * frequency_Hz, decay = damping * angular_frequency;
  const std::vector<double>& time_s = run.seen.time_s;
  std::vector<Swing> result(run.propagated.states.size());
  for (size_t i = 0; i < result.size(); ++i) {
    const double t_s = time_s[i] - time_s.front(), size = std::exp(-decay * t_s);
    const double c = size * std::cos(angular_frequency * t_s);
    const double s = size * std::sin(angular_frequency * t_s);
    result[i].angle_rad = {c, s, 0.0};
    result[i].rate_rad_s = {-decay * c - angular_frequency * s, -decay * s + angular_frequency * c,
                            0.0};
  }
  return result;
}

struct FreeSwing {
  double gain = 0.0;  // expected fall of χ²
  double frequency_Hz = 0.0, damping = 0.0;
  Vec3 direction = Vec3::UnitX();  // in which the body swings
};

// Gain and common direction of free swings with any amplitude in every run.
FreeSwing free_swing_at(const std::vector<PropagatedRun>& runs, double frequency_Hz,
                        double damping) {
  std::vector<Vec3> part, direction;
  for (int k = 0; k < 6; ++k) {
    part.push_back(Vec3::Unit(k % 2));
    direction.push_back(Vec3::Unit(k / 2));
  }
  FreeSwing found{0.0, frequency_Hz, damping};
  Mat3 directions = Mat3::Zero();
  for (const PropagatedRun& run : runs) {
    const Score own = score_of(
        sums_of(run, free_swings(run, frequency_Hz, damping), part, direction, frequency_Hz));
    if (own.estimate.size() != 6) continue;
    found.gain += own.gain;
    for (int k = 0; k < 2; ++k) {
      const Vec3 v(own.estimate[k], own.estimate[k + 2], own.estimate[k + 4]);
      directions += v * v.transpose();
    }
  }
  found.direction = Eigen::SelfAdjointEigenSolver<Mat3>(directions).eigenvectors().col(2);
  return found;
}

// The free swing of largest gain near these lines of the residual.
FreeSwing best_free_swing(const std::vector<PropagatedRun>& runs,
                          const std::vector<double>& lines_Hz, double highest_Hz) {
  constexpr int steps = 3;
  FreeSwing best;
  for (const double line_Hz : lines_Hz) {
    if (line_Hz > highest_Hz) continue;
    FreeSwing near;
    near.frequency_Hz = line_Hz;
    for (double damping = 0.04; damping > 1e-3; damping *= 0.5) {
      const double centre_Hz = near.frequency_Hz;
      for (int k = -steps; k <= steps; ++k) {
        FreeSwing at = free_swing_at(runs, centre_Hz * (1.0 + 0.5 * damping * k), damping);
        if (at.gain > near.gain) near = at;
      }
    }
    if (near.gain > best.gain) best = near;
  }
  return best;
}

}  // namespace

Score score_of_ringing(const std::vector<PropagatedRun>& runs, const Mat3& inertia_kg_m2,
                       const std::vector<Vec3>& axes, double frequency_Hz, double damping) {
  const auto count = static_cast<Eigen::Index>(axes.size());
  std::vector<Vec3> answer_body;
  for (const Vec3& axis : axes) answer_body.push_back(-inertia_kg_m2.inverse() * axis);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(count + 1, count + 1);
  for (const PropagatedRun& run : runs) {
    sums += sums_of(run, swings(run, frequency_Hz, damping), axes, answer_body, frequency_Hz);
  }
  return score_of(sums);
}

std::vector<Start> flexible_mode_starts(const Disturbance& start, const Fit& fit,
                                        const std::vector<Observation>& runs,
                                        const std::vector<Observation>& slow_runs,
                                        const std::vector<double>& lines_Hz,
                                        const Thresholds::Scoring& limits) {
  constexpr double step = 1.2, max_Hz = 5.0;
  constexpr size_t max_starts = 3, max_fast_starts = 2;
  const auto interval_s = [](const Observation& seen) {
    return seen.duration_s() / static_cast<double>(seen.blocks());
  };
  const double highest_Hz = std::min(max_Hz, 0.4 / interval_s(runs.front()));
  // Below this frequency averages resolve a swing, and the platform's motion couples to it. Above
  // it, the platform moves too slowly to couple.
  const double slow_Hz = 0.14 / interval_s(slow_runs.front());
  const Mat3& inertia_kg_m2 = fit.best.model.platform.inertia_kg_m2;
  const std::vector<Prediction> propagated = residuals_of(fit, runs);
  std::vector<PropagatedRun> all;
  for (size_t run = 0; run < runs.size(); ++run) all.push_back({runs[run], propagated[run]});
  std::vector<Start> starts;
  const std::vector<Vec3> axes = axes_of(appendages(start, slow_Hz));
  // A fast appendage follows slow motion like a rigid part of the inertia.
  constexpr double stiff = 5.0;  // times slow_Hz
  const Score carried = score(fit, slow_runs, {appendages(start, stiff * slow_Hz)}).front();
  const auto at = [&](const Tuned& t) {
    const ScoreGroup group = appendages(start, t.frequency_Hz, t.damping);
    const Score alone =
        t.frequency_Hz < slow_Hz
            ? score(fit, slow_runs, {group}).front()
            : together(carried_at(carried, stiff * slow_Hz, t.frequency_Hz), t.ringing);
    return best_appendage(group, alone, inertia_kg_m2);
  };
  const auto start_at_peaks = [&](const std::vector<Mode>& modes, size_t most) {
    std::vector<double> gain;
    for (const Mode& mode : modes) gain.push_back(mode.gain);
    const std::vector<size_t> highest = peaks(gain, most);
    for (const size_t i : highest) {
      if (gain[i] <= limits.min_scan_gain) continue;
      if (gain[i] < limits.min_start_fraction * gain[highest.front()]) {
        starts.push_back({modes[i].start, gain[i]});
        continue;
      }
      const Tuned near = tuned(all, inertia_kg_m2, axes, modes[i].scanned_Hz);
      const Mode sharp = near.ringing.gain > limits.min_scan_gain ? at(near) : Mode{};
      const Mode& best = sharp.gain > gain[i] ? sharp : modes[i];
      starts.push_back({best.start, best.gain});
    }
  };
  std::vector<Mode> modes;
  double f_Hz = std::max(0.02, 2.0 / span_s(runs));
  for (; f_Hz < slow_Hz; f_Hz *= step) {
    const ScoreGroup group = appendages(start, f_Hz);
    modes.push_back(best_appendage(group, score(fit, slow_runs, {group}).front(), inertia_kg_m2));
    modes.back().scanned_Hz = f_Hz;
  }
  start_at_peaks(modes, max_starts);
  modes.clear();
  for (; f_Hz < highest_Hz; f_Hz *= step) {
    Tuned coarse{f_Hz, scanned_damping,
                 score_of_ringing(all, inertia_kg_m2, axes, f_Hz, scanned_damping)};
    modes.push_back(coarse.ringing.gain < limits.min_scan_gain ? Mode{} : at(coarse));
    modes.back().scanned_Hz = f_Hz;
  }
  start_at_peaks(modes, max_fast_starts);
  double most = limits.min_scan_gain;
  for (const Start& driven : starts) most = std::max(most, driven.gain);
  if (const FreeSwing swing = best_free_swing(all, lines_Hz, highest_Hz); swing.gain > most) {
    // The free swing determines only the product J φ. The fit determines J from the swing that the
    // motion drives.
    constexpr double fraction = 0.05;
    const Vec3 axis = (inertia_kg_m2 * swing.direction).normalized();
    const double light_kg_m2 =
        fraction / (1.0 - fraction) / axis.dot(inertia_kg_m2.inverse() * axis);
    Disturbance light = with_parameter(start, "frequency_Hz", swing.frequency_Hz);
    parameter_of(light, "damping").value = swing.damping;
    starts.push_back({heavy(light, axis, light_kg_m2, inertia_kg_m2), swing.gain});
  }
  return starts;
}

}  // namespace photorque
