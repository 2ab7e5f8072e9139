#include "attitude/observation/kinematics.h"

#include <algorithm>
#include <cmath>

#include "attitude/observation/prediction.h"

namespace photorque {

namespace {

// A rotation, and its rate in lab axes.
struct Turning {
  Quat lab_from_body;
  Vec3 rate_lab_rad_s;
};

// A smooth curve through the attitudes. A parabola about each knot gives attitude and rate there,
// and cubics connect the knots.
class SmoothMotion {
 public:
  explicit SmoothMotion(const Observation& seen) {
    for (size_t i = 0; i < seen.blocks(); ++i) {
      if (seen.attitude_rows[i] > 0.0) at_.push_back(i);
    }
    double fastest_rad_s = 1e-3;
    for (size_t n = 0; n + 1 < at_.size(); ++n) {
      const Vec3 turn = turn_vector(seen.attitude[at_[n + 1]] * seen.attitude[at_[n]].conjugate());
      fastest_rad_s =
          std::max(fastest_rad_s, turn.norm() / (seen.time_s[at_[n + 1]] - seen.time_s[at_[n]]));
    }
    const double turns_s = 1.2 / fastest_rad_s;
    const double block_s = (seen.time_s[at_.back()] - seen.time_s[at_.front()]) /
                           std::max(1.0, static_cast<double>(at_.size()) - 1.0);
    const size_t stride = std::clamp<size_t>(
        static_cast<size_t>(std::min(2.0, turns_s) / std::max(block_s, 1e-6)), 6, 60);
    for (size_t n = 0; n < at_.size(); n += stride) add_knot(seen, n, stride / 2 + 1);
    if (time_s_.back() < seen.time_s[at_.back()]) add_knot(seen, at_.size() - 1, stride / 2 + 1);
  }

  Turning at(double t_s) const {
    size_t k = static_cast<size_t>(std::upper_bound(time_s_.begin(), time_s_.end(), t_s) -
                                   time_s_.begin());
    k = std::clamp<size_t>(k, 1, time_s_.size() - 1) - 1;
    const Turning &a = knot_[k], &b = knot_[k + 1];
    const double span_s = time_s_[k + 1] - time_s_[k], x = (t_s - time_s_[k]) / span_s;
    const Vec3 end = turn_vector(b.lab_from_body * a.lab_from_body.conjugate());
    const Vec3 slope_a = span_s * a.rate_lab_rad_s;
    const Vec3 slope_b = span_s * turn_jacobian(end).inverse() * b.rate_lab_rad_s;
    const Vec3 third = slope_a + slope_b - 2.0 * end, second = 3.0 * end - 2.0 * slope_a - slope_b;
    const Vec3 phi = x * (slope_a + x * (second + x * third));
    const Vec3 slope = (slope_a + x * (2.0 * second + 3.0 * x * third)) / span_s;
    return {turn_by(phi) * a.lab_from_body, turn_jacobian(phi) * slope};
  }

 private:
  void add_knot(const Observation& seen, size_t n, size_t reach) {
    const size_t first = n - std::min(n, reach), last = std::min(at_.size(), n + reach + 1);
    const Quat& middle = seen.attitude[at_[n]];
    const double at_s = seen.time_s[at_[n]];
    Mat3 matrix = Mat3::Zero(), right = Mat3::Zero();
    for (size_t m = first; m < last; ++m) {
      const double t = seen.time_s[at_[m]] - at_s;
      const Vec3 powers(1.0, t, t * t);
      matrix += powers * powers.transpose();
      right += powers * turn_vector(seen.attitude[at_[m]] * middle.conjugate()).transpose();
    }
    const Mat3 fitted = matrix.ldlt().solve(right);
    time_s_.push_back(at_s);
    knot_.push_back({turn_by(fitted.row(0).transpose()) * middle, fitted.row(1).transpose()});
  }

  std::vector<size_t> at_;
  std::vector<double> time_s_;
  std::vector<Turning> knot_;
};

// Residuals about a motion in one block; the angle in lab axes.
struct Left {
  Turning motion;
  Vec3 angle_rad = Vec3::Constant(NAN), rate_body_rad_s = Vec3::Constant(NAN);
};

bool is_near(const Prediction& about) {
  // The square of such an angle is a smooth error below the noise of the compared quantities.
  constexpr double farthest_rad = 0.05;
  for (const WhiteRow& off : about.off) {
    if (off.head<3>().array().isFinite().all() && off.head<3>().norm() > farthest_rad) return false;
  }
  return true;
}

std::vector<Left> block_residuals(const Observation& seen, const Prediction* about) {
  std::vector<Left> all(seen.blocks());
  if (about != nullptr && is_near(*about)) {
    for (size_t i = 0; i < seen.blocks(); ++i) {
      const PlatformState& state = about->states[i];
      all[i] = {{state.lab_from_body, state.lab_from_body * state.rate_body_rad_s},
                about->off[i].head<3>(),
                about->off[i].segment<3>(3)};
    }
    return all;
  }
  const SmoothMotion motion(seen);
  for (size_t i = 0; i < seen.blocks(); ++i) {
    Left& left = all[i];
    left.motion = motion.at(seen.time_s[i]);
    const Quat& q = left.motion.lab_from_body;
    if (seen.attitude_rows[i] > 0.0) {
      left.angle_rad = turn_vector(seen.attitude[i] * q.conjugate());
    }
    left.rate_body_rad_s = seen.gyro_rad_s[i] - q.conjugate() * left.motion.rate_lab_rad_s;
    for (int k = 0; k < 3; ++k) {
      if (!(seen.gyro_rows[i][k] > 0.0)) left.rate_body_rad_s[k] = NAN;
    }
  }
  return all;
}

// Marks the blocks before which a command changed, since the previous block.
std::vector<char> jumps_of(const Observation& seen) {
  std::vector<char> jumps(seen.blocks(), 0);
  const Schedule& schedule = seen.schedule;
  ZeroOrderHold last;
  for (size_t c = 0; c < schedule.time_s.size(); ++c) {
    const ZeroOrderHold& now = schedule.held[c];
    const bool same = now.command_body_N_m == last.command_body_N_m &&
                      now.force_lab_N == last.force_lab_N && now.force_body_N == last.force_body_N;
    last = now;
    if (same || schedule.time_s[c] <= seen.time_s.front()) continue;
    const auto next = std::lower_bound(seen.time_s.begin(), seen.time_s.end(), schedule.time_s[c]);
    if (next != seen.time_s.end()) jumps[static_cast<size_t>(next - seen.time_s.begin())] = 1;
  }
  return jumps;
}

}  // namespace

KinematicRun kinematic_run(const Observation& seen, const Prediction* about) {
  const std::vector<Left> left = block_residuals(seen, about);
  const std::vector<char> jumps = jumps_of(seen);
  const double interval_s = reading_interval_s(seen, 0);
  const double gyro_interval_s = reading_interval_s(seen, 3);
  const size_t blocks = seen.blocks();
  KinematicRun result;
  result.about_readings = about == nullptr || !is_near(*about);
  for (const Left& one : left) result.rate_body_rad_s.push_back(one.rate_body_rad_s);
  for (int k = 0; k < 3; ++k) {
    KinematicSeries& s = result.axis[static_cast<size_t>(k)];
    s.time_s = seen.time_s;
    s.rows = seen.attitude_rows;
    s.jumps = jumps;
    s.about_readings = result.about_readings;
    s.interval_s = interval_s;
    s.gyro_interval_s = gyro_interval_s;
    if (!seen.spread.empty()) {
      s.shortest_correlation_s = 0.25 * seen.duration_s() / static_cast<double>(blocks - 1);
    }
    const auto columns = seen.has_gyro ? instrument_columns : 0;
    s.angle_by.setZero(static_cast<Eigen::Index>(blocks), columns);
    s.rate_by.setZero(static_cast<Eigen::Index>(blocks), columns);
    for (size_t i = 0; i < blocks; ++i) {
      const Vec3 lab = left[i].motion.lab_from_body.conjugate() * Vec3::Unit(k);
      s.angle_rad.push_back(left[i].angle_rad[k]);
      s.rate_rad_s.push_back(lab.dot(left[i].rate_body_rad_s));
      s.gyro_share.emplace_back(lab.cwiseAbs2().cwiseQuotient(seen.gyro_rows[i].cwiseMax(1e-9)));
      s.gyro_rows.push_back(seen.gyro_rows[i].maxCoeff());
      if (columns == 0) continue;
      const auto row = static_cast<Eigen::Index>(i);
      const double since_s = seen.time_s[i] - seen.time_s.front();
      const Vec3 rate_body =
          left[i].motion.lab_from_body.conjugate() * left[i].motion.rate_lab_rad_s;
      s.rate_by.block<1, 3>(row, 0) = lab.transpose();
      s.rate_by.block<1, 3>(row, 3) = since_s * lab.transpose();
      for (int j = 0; j < 3; ++j) {
        s.rate_by.block<1, 3>(row, 6 + 3 * j) = lab[j] * rate_body.transpose();
      }
      s.angle_by(row, 15) = -left[i].motion.rate_lab_rad_s[k];
      s.angle_by(row, 16) = since_s * s.angle_by(row, 15);
      s.rate_by(row, clock_drift_column + 1 + k) = 1.0;
    }
  }
  return result;
}

Eigen::VectorXd instrument_widths() {
  Eigen::VectorXd widths(instrument_columns);
  // The rate of the Earth's rotation is 7.3e-5 rad/s.
  widths << Vec3::Constant(0.1), Vec3::Constant(1e-4), Eigen::VectorXd::Constant(9, 0.3), 1.0, 1e-2,
      Vec3::Constant(2e-4);
  return widths;
}

}  // namespace photorque
