#include "attitude/estimation/swing.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/linear.h"

namespace photorque {
namespace {

// The angles about the axis that were read, whole turns counted.
struct AxisAngles {
  std::vector<size_t> row;
  std::vector<double> time_s, angle_rad;
};

AxisAngles angles_about(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  AxisAngles read;
  double angle_rad = 0.0;
  for (size_t i = first; i < last; ++i) {
    if (!(rows.attitude_rows[i] > 0.0)) continue;
    angle_rad += read.row.empty()
                     ? axis.dot(rotation_vector(rows.attitude[i]))
                     : axis.dot(rotation_vector(rows.attitude[i] *
                                                rows.attitude[read.row.back()].conjugate()));
    read.row.push_back(i);
    read.time_s.push_back(rows.time_s[i]);
    read.angle_rad.push_back(angle_rad);
  }
  return read;
}

double middle_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Without what it rests at the end: from where it stays as near to its last angle as a swing hardly
// shows.
void leave_out_rest(AxisAngles& read) {
  constexpr double hardly = 0.01;
  const auto [least, most] = std::minmax_element(read.angle_rad.begin(), read.angle_rad.end());
  const double near_rad = hardly * (*most - *least), end_rad = read.angle_rad.back();
  size_t count = read.row.size();
  while (count > 0 && std::abs(read.angle_rad[count - 1] - end_rad) <= near_rad) --count;
  read.row.resize(count);
  read.time_s.resize(count);
  read.angle_rad.resize(count);
}

// Twice the median time between passages through the median angle; 0 where there are few.
double period_s(const AxisAngles& read) {
  constexpr size_t fewest_passages = 6;
  const double middle_rad = middle_of(read.angle_rad);
  std::vector<double> between_s;
  double before_s = read.time_s.front();
  for (size_t i = 1; i < read.row.size(); ++i) {
    if ((read.angle_rad[i - 1] < middle_rad) == (read.angle_rad[i] < middle_rad)) continue;
    between_s.push_back(read.time_s[i] - before_s);
    before_s = read.time_s[i];
  }
  return between_s.size() < fewest_passages ? 0.0 : 2.0 * middle_of(between_s);
}

// Angle, rate and acceleration at the middles of local cubics; empty where it swings less than
// three times.
struct LocalMotion {
  std::vector<size_t> row;
  Eigen::MatrixXd motion;  // a row each
};

constexpr int steps_per_period = 32;

LocalMotion local_motion(const AxisAngles& read) {
  constexpr size_t fewest = 8, fewest_periods = 3;
  LocalMotion result;
  const double whole_s = period_s(read);
  if (!(whole_s > 0.0)) return result;
  std::vector<double> intervals_s(read.row.size() - 1);
  for (size_t i = 0; i < intervals_s.size(); ++i) {
    intervals_s[i] = read.time_s[i + 1] - read.time_s[i];
  }
  const double step_s = whole_s / steps_per_period,
               reach_s = std::max(2.0 * step_s, 4.001 * middle_of(intervals_s));
  std::vector<Vec3> all;
  size_t begin = 0, end = 0, at = 0;
  for (double t = read.time_s.front() + reach_s; t <= read.time_s.back() - reach_s; t += step_s) {
    while (read.time_s[begin] < t - reach_s) ++begin;
    while (end < read.row.size() && read.time_s[end] <= t + reach_s) ++end;
    while (read.time_s[at] < t) ++at;
    if (end < begin + fewest) continue;
    const auto count = static_cast<Eigen::Index>(end - begin);
    Eigen::MatrixXd powers(count, 4);
    Eigen::VectorXd angles(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const size_t k = begin + static_cast<size_t>(i);
      const double since = (read.time_s[k] - t) / reach_s;
      powers.row(i) << 1.0, since, since * since, since * since * since;
      angles[i] = read.angle_rad[k];
    }
    const Eigen::Vector4d c = least_squares(powers, angles).solution;
    all.emplace_back(c[0], c[1] / reach_s, 2.0 * c[2] / (reach_s * reach_s));
    result.row.push_back(read.row[at]);
  }
  if (all.size() < fewest_periods * steps_per_period) return {};
  result.motion.resize(static_cast<Eigen::Index>(all.size()), 3);
  for (size_t i = 0; i < all.size(); ++i) {
    result.motion.row(static_cast<Eigen::Index>(i)) = all[i].transpose();
  }
  return result;
}

// Residuals of a robust regression; `off`: over its usual scatter or, where that is more, over
// `least` of every row.
struct RobustResidual {
  Eigen::VectorXd left, off;
};

RobustResidual robust_residual(Eigen::MatrixXd law, const Eigen::VectorXd& values,
                               const Eigen::VectorXd& least) {
  constexpr int rounds = 20;
  constexpr double biweight = 4.685, alike = 1e-3;
  law.colwise().normalize();
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(law.rows());
  RobustResidual result;
  for (int round = 0; round < rounds; ++round) {
    result.left =
        values -
        law * least_squares(weight.asDiagonal() * law, weight.cwiseProduct(values), alike).solution;
    const Eigen::VectorXd sizes = result.left.cwiseAbs();
    // The median of |x| of a Gaussian is 0.6745 σ.
    const double scatter = std::max(middle_of({sizes.begin(), sizes.end()}) / 0.6745, 1e-300);
    result.off = result.left.cwiseQuotient(least.cwiseMax(scatter));
    weight = (1.0 - (result.off / biweight).array().square()).max(0.0);
  }
  return result;
}

// The columns of dry, viscous and quadratic friction, and before them those given.
Eigen::MatrixXd with_friction(const Eigen::MatrixXd& motion, const Eigen::MatrixXd& of_angle) {
  Eigen::MatrixXd law(motion.rows(), of_angle.cols() + 3);
  const auto rate = motion.col(1).array();
  law << of_angle, (rate > 0.0).select(Eigen::ArrayXd::Ones(rate.size()), -1.0).matrix(),
      motion.col(1), (rate * rate.abs()).matrix();
  return law;
}

// The residual of the accelerations under the one law, over its usual scatter; over a twentieth of
// the largest acceleration within half a period where that is more, because local cubics are off by
// such a part.
Eigen::VectorXd off_the_law(const Eigen::MatrixXd& motion) {
  constexpr double part = 0.05 / 3.0;
  constexpr Eigen::Index half_period = steps_per_period / 2;
  Eigen::MatrixXd of_angle(motion.rows(), 4);
  const auto angle = motion.col(0).array();
  of_angle << Eigen::VectorXd::Ones(motion.rows()), angle.sin().matrix(), angle.cos().matrix(),
      motion.col(0);
  Eigen::VectorXd least(motion.rows());
  for (Eigen::Index i = 0; i < least.size(); ++i) {
    const Eigen::Index from = std::max<Eigen::Index>(0, i - half_period),
                       to = std::min(least.size(), i + half_period + 1);
    least[i] = part * motion.col(2).segment(from, to - from).cwiseAbs().maxCoeff();
  }
  return robust_residual(with_friction(motion, of_angle), motion.col(2), least).off;
}

// The swing within the rows, if there is one.
LocalMotion swing_of(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  constexpr size_t fewest_readings = 60;
  AxisAngles read = angles_about(rows, axis, first, last);
  if (read.row.size() < fewest_readings) return {};
  leave_out_rest(read);
  return read.row.size() < fewest_readings ? LocalMotion() : local_motion(read);
}

}  // namespace

size_t released_at(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  constexpr double usual = 3.0;
  const LocalMotion local = swing_of(rows, axis, first, last);
  if (local.row.empty()) return first;
  const Eigen::VectorXd off = off_the_law(local.motion);
  int lawful = 0;
  for (size_t i = 0; i < local.row.size() / 4; ++i) {
    lawful = std::abs(off[static_cast<Eigen::Index>(i)]) < usual ? lawful + 1 : 0;
    if (lawful < steps_per_period / 4) continue;
    const size_t begins = i + 1 - steps_per_period / 4;
    return begins == 0 ? first : local.row[begins];
  }
  return first;
}

RestoringLaw restoring_law(const Observation& rows, const Vec3& axis) {
  constexpr double clearly = 0.5, of_largest = 0.5;
  const LocalMotion local = swing_of(rows, axis, 0, rows.blocks());
  if (local.row.empty()) return RestoringLaw::unclear;
  const Eigen::MatrixXd& motion = local.motion;
  // Far from the middle the laws differ most.
  const double middle_rad = middle_of({motion.col(0).begin(), motion.col(0).end()});
  const Eigen::ArrayXd away_rad = (motion.col(0).array() - middle_rad).abs();
  const double far_rad = of_largest * away_rad.maxCoeff();
  const auto scatter = [&](const Eigen::VectorXd& first, const Eigen::VectorXd& second) {
    Eigen::MatrixXd of_angle(motion.rows(), 2);
    of_angle << first, second;
    const Eigen::VectorXd left = robust_residual(with_friction(motion, of_angle), motion.col(2),
                                                 Eigen::VectorXd::Zero(motion.rows()))
                                     .left;
    std::vector<double> far;
    for (Eigen::Index i = 0; i < left.size(); ++i) {
      if (away_rad[i] > far_rad) far.push_back(std::abs(left[i]));
    }
    return middle_of(std::move(far));
  };
  const auto angle = motion.col(0).array();
  const double of_weight = scatter(angle.sin(), angle.cos()),
               of_spring = scatter(Eigen::VectorXd::Ones(motion.rows()), motion.col(0));
  if (of_spring < clearly * of_weight) return RestoringLaw::spring;
  return of_weight < clearly * of_spring ? RestoringLaw::weight : RestoringLaw::unclear;
}

}  // namespace photorque
