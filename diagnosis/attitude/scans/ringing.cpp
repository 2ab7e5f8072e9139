#include "diagnosis/attitude/scans/ringing.h"

#include <algorithm>
#include <cmath>

#include "attitude/observation/whitening.h"

#include "core/constants.h"

namespace photorque {
namespace {

// Of swinging masses about the three body axes, beside the body.
struct Swing {
  Vec3 angle_rad = Vec3::Zero(), rate_rad_s = Vec3::Zero();
};

// φ'' + 2 ζ ω φ' + ω² φ = −dω_body/dt, from rest beside the body, the acceleration constant between
// readings: exact for uneven times.
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

// Takes the mean over `window` neighbours (odd) from every row.
void take_out_slow(Eigen::MatrixXd& rows, Eigen::Index window) {
  const Eigen::Index n = rows.rows(), half = window / 2;
  Eigen::MatrixXd until(n + 1, rows.cols());  // sums of the rows before
  until.row(0).setZero();
  for (Eigen::Index i = 0; i < n; ++i) until.row(i + 1) = until.row(i) + rows.row(i);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index first = std::max<Eigen::Index>(0, i - half);
    const Eigen::Index last = std::min(n, i + half + 1);
    rows.row(i) -= (until.row(last) - until.row(first)) / static_cast<double>(last - first);
  }
}

// Of one channel, where it was read: the whitened answer to each appendage, then the residual.
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

}  // namespace

Score score_of_ringing(const std::vector<PropagatedRun>& runs, const Mat3& inertia_kg_m2,
                       const std::vector<Vec3>& axes, double frequency_Hz, double damping) {
  const auto count = static_cast<Eigen::Index>(axes.size());
  std::vector<Vec3> answer_body;
  for (const Vec3& axis : axes) answer_body.push_back(-inertia_kg_m2.inverse() * axis);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(count + 1, count + 1);
  for (const PropagatedRun& run : runs) {
    const std::vector<Swing> swing = swings(run, frequency_Hz, damping);
    for (Eigen::Index channel = 0; channel < 6; ++channel) {
      Eigen::MatrixXd rows = answers(run, swing, axes, answer_body, channel);
      if (rows.rows() == 0) continue;
      const double a_second = static_cast<double>(rows.rows()) / run.seen.duration_s();
      const auto half = static_cast<Eigen::Index>(0.5 * a_second / frequency_Hz);
      take_out_slow(rows, 2 * std::max<Eigen::Index>(1, half) + 1);
      sums += rows.transpose() * rows;
    }
  }
  return solve_score(sums.topLeftCorner(count, count), sums.col(count).head(count),
                     sums.diagonal().head(count));
}

}  // namespace photorque
