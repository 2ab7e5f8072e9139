#include "attitude/estimation/swing.h"

#include <algorithm>
#include <cmath>

#include "attitude/estimation/axis_readings.h"
#include "core/constants.h"
#include "core/numerics/linear.h"
#include "core/numerics/median.h"

namespace photorque {

std::vector<Passage> passages(const std::vector<double>& time_s, const std::vector<double>& values,
                              double least) {
  constexpr double far = 0.2, most_of_usual = 4.0;
  std::vector<double> sizes;
  for (const double value : values) {
    if (std::abs(value) >= least) sizes.push_back(std::abs(value));
  }
  if (sizes.empty()) return {};
  const double usual = upper_median(std::move(sizes));
  double nearby = usual, extreme = 0.0;
  std::vector<Passage> all;
  int side = 0;
  size_t before = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const double value = values[i], limit = std::max(far * nearby, least);
    const int now = value > limit ? 1 : value < -limit ? -1 : 0;
    if (now != 0 && now == -side) {
      const double first = values[before], second = values[before + 1];
      const double part = first / (first - second);
      all.push_back(
          {before, time_s[before] + part * (time_s[before + 1] - time_s[before]), extreme});
      nearby = std::min(extreme, most_of_usual * usual);
      extreme = 0.0;
    }
    if (now != 0) side = now;
    if (value * side > 0.0) before = i;
    extreme = std::max(extreme, std::abs(value));
  }
  return all;
}

namespace {

// Removes the rest at the end: the readings from which on the angle stays within 1 % of the range
// around its last value.
void leave_out_rest(AxisReadings& read) {
  constexpr double hardly = 0.01;
  const auto [least, most] = std::minmax_element(read.value.begin(), read.value.end());
  const double near_rad = hardly * (*most - *least), end_rad = read.value.back();
  size_t count = read.row.size();
  while (count > 0 && std::abs(read.value[count - 1] - end_rad) <= near_rad) --count;
  read.row.resize(count);
  read.time_s.resize(count);
  read.value.resize(count);
}

std::vector<Passage> passages_through_median(const AxisReadings& read) {
  const double middle = upper_median(read.value);
  std::vector<double> deviation;
  for (const double value : read.value) deviation.push_back(value - middle);
  return passages(read.time_s, deviation, 0.0);
}

// Twice the median time between passages through the median angle; 0 if there are fewer than six.
double period_s(const AxisReadings& read) {
  constexpr size_t fewest_passages = 6;
  const std::vector<Passage> all = passages_through_median(read);
  if (all.size() < fewest_passages) return 0.0;
  std::vector<double> between_s;
  for (size_t i = 1; i < all.size(); ++i) between_s.push_back(all[i].time_s - all[i - 1].time_s);
  return 2.0 * upper_median(between_s);
}

// Angle, rate and acceleration at the centres of local cubics; empty for fewer than three periods.
struct LocalMotion {
  std::vector<size_t> row;
  std::vector<double> time_s;
  Eigen::MatrixXd motion;  // one row per centre: angle, rate, acceleration
  bool is_fine = false;    // each cubic spans at most about a quarter of a period
};

constexpr int steps_per_period = 32;

LocalMotion local_motion(const AxisReadings& read) {
  constexpr size_t fewest = 6, fewest_periods = 3;
  LocalMotion result;
  const double whole_s = read.row.empty() ? 0.0 : period_s(read);
  if (!(whole_s > 0.0)) return result;
  std::vector<double> intervals_s(read.row.size() - 1);
  for (size_t i = 0; i < intervals_s.size(); ++i) {
    intervals_s[i] = read.time_s[i + 1] - read.time_s[i];
  }
  const double step_s = whole_s / steps_per_period,
               reach_s = std::max(2.0 * step_s, 4.001 * upper_median(intervals_s));
  constexpr double fine = 1.0 / 7.0;  // of a period, on either side
  result.is_fine = reach_s < fine * whole_s;
  std::vector<Vec3> all;
  size_t begin = 0, end = 0, at = 0;
  for (double t = read.time_s.front() + reach_s; t <= read.time_s.back() - reach_s; t += step_s) {
    while (read.time_s[begin] < t - reach_s) ++begin;
    while (end < read.row.size() && read.time_s[end] <= t + reach_s) ++end;
    while (read.time_s[at] < t) ++at;
    if (end < begin + fewest) continue;
    const Eigen::Vector4d c = fitted_cubic(read, begin, end, t, reach_s);
    all.emplace_back(c[0], c[1] / reach_s, 2.0 * c[2] / (reach_s * reach_s));
    result.row.push_back(read.row[at]);
    result.time_s.push_back(t);
  }
  if (all.size() < fewest_periods * steps_per_period) return {};
  result.motion.resize(static_cast<Eigen::Index>(all.size()), 3);
  for (size_t i = 0; i < all.size(); ++i) {
    result.motion.row(static_cast<Eigen::Index>(i)) = all[i].transpose();
  }
  return result;
}

// Residuals of a robust regression. `off`: the residuals in units of their usual scatter or, if
// that is larger, of the row's entry of `least`.
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
    const double scatter =
        std::max(upper_median({sizes.begin(), sizes.end()}) / normal_median, 1e-300);
    result.off = result.left.cwiseQuotient(least.cwiseMax(scatter));
    weight = (1.0 - (result.off / biweight).array().square()).max(0.0);
  }
  return result;
}

// The columns `of_angle`, followed by those of dry, viscous and quadratic friction.
Eigen::MatrixXd with_friction(const Eigen::MatrixXd& motion, const Eigen::MatrixXd& of_angle) {
  Eigen::MatrixXd law(motion.rows(), of_angle.cols() + 3);
  const auto rate = motion.col(1).array();
  law << of_angle, (rate > 0.0).select(Eigen::ArrayXd::Ones(rate.size()), -1.0).matrix(),
      motion.col(1), (rate * rate.abs()).matrix();
  return law;
}

// Residuals of the accelerations under the common law, in units of their usual scatter or of 5 %/3
// of the largest acceleration within half a period, if that is larger. The error of local cubics
// has about this size.
Eigen::VectorXd scaled_residuals(const Eigen::MatrixXd& motion) {
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

// Integral from the first time to each time, by the trapezoidal rule.
std::vector<double> integral(const std::vector<double>& time_s, const std::vector<double>& values) {
  std::vector<double> sum = {0.0};
  for (size_t i = 1; i < values.size(); ++i) {
    sum.push_back(sum.back() + 0.5 * (values[i] + values[i - 1]) * (time_s[i] - time_s[i - 1]));
  }
  return sum;
}

// A turning point of a swing, with the integrated angle there.
struct TurningPoint {
  double time_s = 0.0, angle_rad = 0.0;
};

std::vector<TurningPoint> turning_points(const AxisReadings& rates,
                                         const std::vector<double>& turned_rad) {
  constexpr double least_of_largest = 0.02;
  double largest = 0.0;
  for (const double rate : rates.value) largest = std::max(largest, std::abs(rate));
  std::vector<TurningPoint> points;
  for (const Passage& p : passages(rates.time_s, rates.value, least_of_largest * largest)) {
    points.push_back({rates.time_s[p.before], turned_rad[p.before]});
  }
  return points;
}

// Centres of the swing at the turning points: the mean of a point and of the mean of its two
// neighbours. Bias and noise of the rates shift them.
std::vector<TurningPoint> middles(const std::vector<TurningPoint>& points) {
  std::vector<TurningPoint> result;
  for (size_t i = 1; i + 1 < points.size(); ++i) {
    result.push_back({points[i].time_s, 0.25 * points[i - 1].angle_rad + 0.5 * points[i].angle_rad +
                                            0.25 * points[i + 1].angle_rad});
  }
  return result;
}

bool are_regular(const std::vector<TurningPoint>& points) {
  constexpr double alike = 2.0;
  std::vector<double> between_s;
  for (size_t i = 1; i < points.size(); ++i) {
    between_s.push_back(points[i].time_s - points[i - 1].time_s);
  }
  std::ranges::sort(between_s);
  const size_t tenth = between_s.size() / 10;
  return between_s[between_s.size() - 1 - tenth] < alike * between_s[tenth];
}

}  // namespace

AxisReadings angles_of_swing(const Observation& rows, const Vec3& axis) {
  constexpr size_t fewest_readings = 40, fewest_points = 4;
  AxisReadings read = rates_about(rows, axis, 0, rows.blocks());
  if (read.row.size() < fewest_readings) return {};
  const std::vector<double> turned_rad = integral(read.time_s, read.value);
  const std::vector<TurningPoint> points = turning_points(read, turned_rad);
  if (points.size() < fewest_points || !are_regular(points)) return {};
  const std::vector<TurningPoint> middle = middles(points);
  size_t next = 0;
  for (size_t i = 0; i < read.row.size(); ++i) {
    const double t = read.time_s[i];
    while (next < middle.size() && middle[next].time_s < t) ++next;
    double zero_rad = middle[next == 0 ? 0 : next - 1].angle_rad;
    if (next > 0 && next < middle.size()) {
      const TurningPoint &before = middle[next - 1], &after = middle[next];
      zero_rad += (after.angle_rad - before.angle_rad) * (t - before.time_s) /
                  (after.time_s - before.time_s);
    }
    read.value[i] = turned_rad[i] - zero_rad;
  }
  return read;
}

namespace {

// Whether a torque that changes once per turn explains most of what a constant torque and friction
// do not: it halves the sum of squares of the rates.
bool shows_weight(const AxisReadings& rates, const std::vector<double>& turned_rad) {
  constexpr double clearly = 0.5, alike = 1e-6;
  const auto count = static_cast<Eigen::Index>(rates.row.size());
  Eigen::MatrixXd motion(count, 2), of_angle(count, 3);
  motion << Eigen::Map<const Eigen::VectorXd>(turned_rad.data(), count),
      Eigen::Map<const Eigen::VectorXd>(rates.value.data(), count);
  of_angle << Eigen::VectorXd::Ones(count), motion.col(0).array().sin().matrix(),
      motion.col(0).array().cos().matrix();
  const auto left = [&](Eigen::Index of_angle_used) {
    const Eigen::MatrixXd torques = with_friction(motion, of_angle.leftCols(of_angle_used));
    Eigen::MatrixXd law(count, torques.cols() + 1);
    law.col(0).setOnes();
    for (Eigen::Index k = 0; k < torques.cols(); ++k) {
      const std::vector<double> torque(torques.col(k).begin(), torques.col(k).end()),
          sum = integral(rates.time_s, torque);
      law.col(k + 1) = Eigen::Map<const Eigen::VectorXd>(sum.data(), count);
    }
    law.colwise().normalize();
    const Eigen::VectorXd rate = motion.col(1);
    return (rate - law * least_squares(law, rate, alike).solution).squaredNorm();
  };
  return left(3) < clearly * left(1);
}

}  // namespace

AxisReadings angles_over_weight(const Observation& rows, const Vec3& axis) {
  constexpr size_t fewest_readings = 40, reach = 4;
  const bool sees_angle = rows.has_some_attitude();
  AxisReadings rates = sees_angle ? angles_about(rows, axis, 0, rows.blocks())
                                  : rates_about(rows, axis, 0, rows.blocks());
  if (rates.row.size() < fewest_readings) return {};
  AxisReadings angles = rates;
  if (sees_angle) {
    for (size_t i = 0; i < rates.row.size(); ++i) {
      const size_t first = i - std::min(i, reach), last = std::min(rates.row.size(), i + reach + 1);
      rates.value[i] = fitted_cubic(angles, first, last, rates.time_s[i], 1.0, angles.value[i])[1];
    }
  } else {
    angles.value = integral(rates.time_s, rates.value);
  }
  // Readings more than a quarter of a turn apart do not resolve a turn.
  for (size_t i = 1; i < angles.value.size(); ++i) {
    if (std::abs(angles.value[i] - angles.value[i - 1]) > 0.5 * pi) return {};
  }
  const auto [least, most] = std::ranges::minmax(angles.value);
  return most - least > pi && shows_weight(rates, angles.value) ? angles : AxisReadings();
}

AxisReadings angles_from_rates(const Observation& rows, const Vec3& axis) {
  AxisReadings swing = angles_of_swing(rows, axis);
  return swing.row.empty() ? angles_over_weight(rows, axis) : swing;
}

bool swings(const std::vector<Observation>& runs, const Vec3& axis) {
  constexpr double beyond = 0.2;
  constexpr int fewest = 3;
  std::vector<double> angle_rad;
  for (const Observation& seen : runs) {
    if (!seen.has_some_attitude() && !angles_of_swing(seen, axis).row.empty()) return true;
    const std::vector<double> of_run = angles_about(seen, axis, 0, seen.blocks()).value;
    angle_rad.insert(angle_rad.end(), of_run.begin(), of_run.end());
  }
  if (angle_rad.empty()) return false;
  double mean_rad = 0.0, most_rad = 0.0;
  for (const double a : angle_rad) mean_rad += a / static_cast<double>(angle_rad.size());
  for (double& a : angle_rad) most_rad = std::max(most_rad, std::abs(a -= mean_rad));
  int times = 0, side = 0;
  for (const double a : angle_rad) {
    const int now = a > beyond * most_rad ? 1 : a < -beyond * most_rad ? -1 : 0;
    times += now == -side ? std::abs(now) : 0;
    if (now != 0) side = now;
  }
  return times >= fewest;
}

namespace {

// Angles of a swing in the rows, without the rest at the end; empty if there are few.
AxisReadings swing_of(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  constexpr size_t fewest_readings = 40;
  AxisReadings read = rows.has_some_attitude() ? angles_about(rows, axis, first, last)
                                               : angles_of_swing(rows, axis);
  if (read.row.size() >= fewest_readings) leave_out_rest(read);
  return read.row.size() < fewest_readings ? AxisReadings() : read;
}

// A series at the steps of local motion, minus its mean over a period around each step. Small
// errors of an angle that last long accumulate in integrals; subtracting the mean removes them.
Eigen::VectorXd without_slow_part(const Eigen::VectorXd& values) {
  constexpr Eigen::Index half = steps_per_period / 2;
  Eigen::VectorXd result(values.size() - 2 * half);
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const double ends = 0.5 * (values[i] + values[i + 2 * half]);
    result[i] =
        values[i + half] - (values.segment(i + 1, 2 * half - 1).sum() + ends) / (2.0 * half);
  }
  return result;
}

// Arithmetic-geometric mean.
double agm(double a, double b) {
  while (std::abs(a - b) > 1e-12 * a) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return a;
}

// A period of a swing, between every second passage through its centre, and its amplitude.
struct Period {
  double period_s = 0.0, amplitude_rad = 0.0;
  double least_rad = 0.0;  // the smaller extreme on the two sides
};

std::vector<Period> periods_of(const AxisReadings& read) {
  const std::vector<Passage> passed = passages_through_median(read);
  std::vector<Period> all;
  for (size_t i = 2; i < passed.size(); ++i) {
    all.push_back({passed[i].time_s - passed[i - 2].time_s,
                   0.5 * (passed[i - 1].extreme + passed[i].extreme),
                   std::min(passed[i - 1].extreme, passed[i].extreme)});
  }
  return all;
}

// The period of a weight increases with the amplitude A: it is T/agm(1, cos(A/2)). The period of a
// spring is constant. Driving and damping torques and a coarse resolution of the readings have
// little effect on it.
RestoringLaw law_of_periods(const AxisReadings& read) {
  constexpr size_t fewest = 2, many = 8;
  const std::vector<Period> periods = periods_of(read);
  if (periods.size() < fewest) return RestoringLaw::unclear;
  std::vector<double> of_spring, of_weight;
  for (const Period& p : periods) {
    // A weight that turns back on both sides lies between the highest positions, a turn apart.
    if (p.least_rad > pi) return RestoringLaw::spring;
    if (p.amplitude_rad > pi) return RestoringLaw::unclear;
    of_spring.push_back(std::log(p.period_s));
    of_weight.push_back(of_spring.back() + std::log(agm(1.0, std::cos(0.5 * p.amplitude_rad))));
  }
  // The medians of many periods exclude those in which the body rests or is pushed.
  const bool are_many = periods.size() >= many;
  const auto scatter = [are_many](const std::vector<double>& values) {
    const double middle = upper_median(values);
    std::vector<double> sizes;
    for (const double value : values) sizes.push_back(std::abs(value - middle));
    return are_many ? upper_median(sizes) : *std::ranges::max_element(sizes);
  };
  const double clearly = are_many ? 2.0 : 8.0, spring = scatter(of_spring),
               weight = scatter(of_weight);
  return clearly * spring < weight   ? RestoringLaw::spring
         : clearly * weight < spring ? RestoringLaw::weight
                                     : RestoringLaw::unclear;
}

}  // namespace

size_t released_at(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  constexpr double usual = 3.0, held = 4.5;
  const LocalMotion local = local_motion(swing_of(rows, axis, first, last));
  if (local.row.empty()) return first;
  const Eigen::VectorXd off = scaled_residuals(local.motion);
  int lawful = 0;
  double largest = 0.0;
  for (size_t i = 0; i < local.row.size() / 4; ++i) {
    const double size = std::abs(off[static_cast<Eigen::Index>(i)]);
    largest = std::max(largest, size);
    lawful = size < usual ? lawful + 1 : 0;
    if (lawful < steps_per_period / 4) continue;
    return largest < held ? first : local.row[i + 1 - steps_per_period / 4];
  }
  return first;
}

RestoringLaw restoring_law(const Observation& rows, const Vec3& axis) {
  constexpr double beyond_chance = 16.0, clearly = 0.1;
  const AxisReadings read = swing_of(rows, axis, 0, rows.blocks());
  if (read.row.empty()) return RestoringLaw::unclear;
  if (const RestoringLaw law = law_of_periods(read); law != RestoringLaw::unclear) return law;
  const LocalMotion local = local_motion(read);
  if (local.row.empty() || !local.is_fine) return RestoringLaw::unclear;
  const Eigen::MatrixXd& motion = local.motion;
  const auto angle = motion.col(0).array();
  const Eigen::VectorXd rate = without_slow_part(motion.col(1));
  const auto residual = [&](const Eigen::VectorXd& first, const Eigen::VectorXd& second) {
    Eigen::MatrixXd of_angle(motion.rows(), 2);
    of_angle << first, second;
    Eigen::MatrixXd law = with_friction(motion, of_angle);
    for (Eigen::Index k = 0; k < law.cols(); ++k) {
      const std::vector<double> sum =
          integral(local.time_s, std::vector<double>(law.col(k).begin(), law.col(k).end()));
      law.col(k) = Eigen::Map<const Eigen::VectorXd>(sum.data(), law.rows());
    }
    Eigen::MatrixXd fast(rate.size(), law.cols());
    for (Eigen::Index k = 0; k < law.cols(); ++k) fast.col(k) = without_slow_part(law.col(k));
    fast.colwise().normalize();
    return Eigen::VectorXd(rate - fast * least_squares(fast, rate).solution);
  };
  const Eigen::VectorXd of_weight = residual(angle.sin(), angle.cos()),
                        of_spring = residual(Eigen::VectorXd::Ones(motion.rows()), motion.col(0));
  const bool is_spring = of_spring.squaredNorm() < of_weight.squaredNorm();
  const Eigen::VectorXd &better = is_spring ? of_spring : of_weight,
                        &worse = is_spring ? of_weight : of_spring;
  // Neighbouring residuals are correlated, which reduces the number of independent ones.
  const Eigen::Index count = better.size() - 1;
  const double alike =
      std::clamp(better.head(count).dot(better.tail(count)) / better.squaredNorm(), 0.0, 0.999);
  const double independent = static_cast<double>(count) * (1.0 - alike) / (1.0 + alike),
               gain = std::log(worse.squaredNorm() / better.squaredNorm());
  if (!(gain > clearly) || !(independent * gain > beyond_chance)) return RestoringLaw::unclear;
  return is_spring ? RestoringLaw::spring : RestoringLaw::weight;
}

}  // namespace photorque
