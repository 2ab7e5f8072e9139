#include "attitude/estimation/release.h"

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

// Angle, rate and acceleration at the middles of local cubics.
struct LocalMotion {
  std::vector<size_t> row;
  Eigen::MatrixXd motion;  // a row each
};

LocalMotion local_motion(const AxisAngles& read, double reach_s, double step_s) {
  constexpr size_t fewest = 8;
  LocalMotion result;
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
  result.motion.resize(static_cast<Eigen::Index>(all.size()), 3);
  for (size_t i = 0; i < all.size(); ++i) {
    result.motion.row(static_cast<Eigen::Index>(i)) = all[i].transpose();
  }
  return result;
}

// The residual of the accelerations under the one law, over its usual scatter; over a twentieth of
// the largest acceleration within half a period where that is more, because local cubics are off by
// such a part.
Eigen::VectorXd off_the_law(const Eigen::MatrixXd& motion, Eigen::Index half_period) {
  constexpr int rounds = 20;
  constexpr double biweight = 4.685, alike = 1e-3, part = 0.05 / 3.0;
  Eigen::MatrixXd law(motion.rows(), 7);
  for (Eigen::Index i = 0; i < motion.rows(); ++i) {
    const double angle = motion(i, 0), rate = motion(i, 1);
    law.row(i) << 1.0, std::sin(angle), std::cos(angle), angle, rate > 0.0 ? 1.0 : -1.0, rate,
        rate * std::abs(rate);
  }
  law.colwise().normalize();
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(motion.rows()), off;
  for (int round = 0; round < rounds; ++round) {
    off = motion.col(2) -
          law * least_squares(weight.asDiagonal() * law, weight.cwiseProduct(motion.col(2)), alike)
                    .solution;
    std::vector<double> sizes(off.size());
    for (Eigen::Index i = 0; i < off.size(); ++i) sizes[static_cast<size_t>(i)] = std::abs(off[i]);
    // The median of |x| of a Gaussian is 0.6745 σ.
    const double scatter = std::max(middle_of(sizes) / 0.6745, 1e-300);
    for (Eigen::Index i = 0; i < off.size(); ++i) {
      const Eigen::Index from = std::max<Eigen::Index>(0, i - half_period),
                         to = std::min(off.size(), i + half_period + 1);
      const double largest = motion.col(2).segment(from, to - from).cwiseAbs().maxCoeff();
      off[i] /= std::max(scatter, part * largest);
      const double x = off[i] / biweight;
      weight[i] = std::max(0.0, 1.0 - x * x);
    }
  }
  return off;
}

}  // namespace

size_t released_at(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  constexpr size_t fewest_readings = 200;
  constexpr int steps_per_period = 32;
  constexpr double usual = 3.0;
  AxisAngles read = angles_about(rows, axis, first, last);
  if (read.row.size() < fewest_readings) return first;
  leave_out_rest(read);
  if (read.row.size() < fewest_readings) return first;
  const double whole_s = period_s(read);
  if (!(whole_s > 0.0)) return first;
  const LocalMotion local =
      local_motion(read, 2.0 * whole_s / steps_per_period, whole_s / steps_per_period);
  if (local.row.size() < 3 * steps_per_period) return first;
  const Eigen::VectorXd off = off_the_law(local.motion, steps_per_period / 2);
  int lawful = 0;
  for (size_t i = 0; i < local.row.size() / 4; ++i) {
    lawful = std::abs(off[static_cast<Eigen::Index>(i)]) < usual ? lawful + 1 : 0;
    if (lawful < steps_per_period / 4) continue;
    const size_t begins = i + 1 - steps_per_period / 4;
    return begins == 0 ? first : local.row[begins];
  }
  return first;
}

}  // namespace photorque
