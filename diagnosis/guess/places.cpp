#include "diagnosis/guess/places.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "attitude/estimation/swing.h"
#include "core/constants.h"
#include "core/numerics/linear.h"
#include "core/numerics/median.h"
#include "core/transform.h"

namespace photorque {

namespace {

using Eigen::Vector2d;

std::vector<Vector2d> places_of(const Recording& recording) {
  const Channel *x = recording.find("x_m"), *y = recording.find("y_m");
  std::vector<Vector2d> points;
  for (size_t i = 0; x != nullptr && y != nullptr && i < recording.rows(); ++i) {
    const Vector2d point(x->values[i], y->values[i]);
    if (point.allFinite()) points.push_back(point);
  }
  return points;
}

// Circle with the limit of the distances [m] at which a point counts as an outlier.
struct FittedCircle {
  Vector2d centre_m;
  double radius_m = 0.0, reach_m = 0.0;
};

// |p − c|² = R² is linear in c and R² − |c|² (I. Kåsa, IEEE Trans. Instrum. Meas. 25, 8 (1976)).
// The radius is too small for short arcs. Nothing for fewer than three points.
std::optional<FittedCircle> linear_fit(const std::vector<Vector2d>& points) {
  Vector2d mean = Vector2d::Zero();
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  Mat3 squares = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  for (const auto& p : points) {
    const Vector2d d = p - mean;
    const Vec3 row(2.0 * d.x(), 2.0 * d.y(), 1.0);
    squares += row * row.transpose();
    right += row * d.squaredNorm();
  }
  const Vec3 solved = squares.ldlt().solve(right);
  if (points.size() < 3 || !solved.allFinite()) return std::nullopt;
  return FittedCircle{mean + solved.head<2>(),
                      std::sqrt(std::max(0.0, solved[2] + solved.head<2>().squaredNorm()))};
}

// Minimises the distances from the circle with Tukey's biweight, starting from linear_fit().
std::optional<FittedCircle> robust_fit(const std::vector<Vector2d>& points) {
  constexpr int rounds = 20;
  constexpr double biweight = 4.685;  // 95 % efficiency for Gaussian errors
  std::optional<FittedCircle> circle = linear_fit(points);
  for (int round = 0; circle && round < rounds; ++round) {
    std::vector<double> sizes;
    for (const auto& p : points) {
      sizes.push_back(std::abs((p - circle->centre_m).norm() - circle->radius_m));
    }
    circle->reach_m = std::max(biweight * upper_median(sizes) / normal_median, 1e-300);
    Mat3 squares = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (const auto& p : points) {
      const Vector2d d = p - circle->centre_m;
      if (!(d.norm() > 0.0)) continue;
      const double off_m = d.norm() - circle->radius_m,
                   weight = std::pow(std::max(0.0, 1.0 - std::pow(off_m / circle->reach_m, 2)), 2);
      const Vec3 row(d.x() / d.norm(), d.y() / d.norm(), 1.0);
      squares += weight * row * row.transpose();
      right += weight * off_m * row;
    }
    const Vec3 step = squares.ldlt().solve(right);
    if (!step.allFinite()) return std::nullopt;
    circle->centre_m += step.head<2>();
    circle->radius_m += step[2];
  }
  return circle;
}

// Number of turning points that are more than `apart` from each other.
int turning_points(const std::vector<double>& values, double apart) {
  int turns = 0, sense = 0;
  double extreme = 0.0;
  for (const double a : values) {
    if (sense * (a - extreme) > 0.0 || sense == 0) {
      if (sense != 0) extreme = a;
      if (sense == 0 && std::abs(a) > apart) {
        sense = a > 0.0 ? 1 : -1;
        extreme = a;
      }
    } else if (std::abs(a - extreme) > apart) {
      sense = -sense;
      extreme = a;
      ++turns;
    }
  }
  return turns;
}

}  // namespace

std::optional<Circle> circle_of(const Recording& recording) {
  const std::vector<Vector2d> points = places_of(recording);
  const std::optional<FittedCircle> circle = robust_fit(points);
  if (!circle) return std::nullopt;
  const double radius_m = circle->radius_m;
  double square = 0.0, kept = 0.0, at = 0.0, low = 0.0, high = 0.0, before = NAN;
  std::vector<double> angle_rad;  // from the first point, with whole turns
  for (const auto& p : points) {
    const Vector2d d = p - circle->centre_m;
    if (std::abs(d.norm() - radius_m) > circle->reach_m) continue;
    square += std::pow(d.norm() - radius_m, 2.0);
    kept += 1.0;
    const double direction = std::atan2(d.y(), d.x());
    if (std::isfinite(before)) at += std::remainder(direction - before, 2.0 * pi);
    before = direction;
    angle_rad.push_back(at);
    low = std::min(low, at);
    high = std::max(high, at);
  }
  // The arc must be higher than the scatter: a straight line is part of any large circle.
  constexpr double max_scatter = 0.02, round_rad = 2.0, scatters = 10.0, turn_of_range = 0.2;
  const double relative = std::sqrt(square / kept) / radius_m, range_rad = high - low,
               height = 1.0 - std::cos(0.5 * std::min(range_rad, pi));
  const bool swings = turning_points(angle_rad, turn_of_range * range_rad) >= 2;
  const bool is_arc = (swings && height > scatters * relative) || range_rad > round_rad;
  if (!(radius_m > 0.0) || !(relative < max_scatter) || !is_arc) return std::nullopt;
  return Circle{circle->centre_m, radius_m, relative};
}

std::optional<Oscillation> oscillation_of(const Recording& recording,
                                          const Eigen::Vector2d& noise_m) {
  constexpr size_t fewest_half_periods = 6, fewest_of_clear = 3;
  constexpr double least_fullness = 0.58, noise_levels = 3.0, fewest_readings = 3.0, regular = 0.65;
  constexpr double clear = 20.0;  // noise levels of an amplitude that needs fewer half-periods
  Oscillation found;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const Channel* coordinate = recording.find(axis == 0 ? "x_m" : "y_m");
    if (coordinate == nullptr) continue;
    std::vector<double> time_s, value_m;
    for (size_t i = 0; i < recording.rows(); ++i) {
      if (!std::isfinite(coordinate->values[i])) continue;
      time_s.push_back(recording.time_s[i]);
      value_m.push_back(coordinate->values[i]);
    }
    if (value_m.empty()) continue;
    found.middle_m[axis] = upper_median(value_m);
    double farthest_m = 0.0;
    for (double& value : value_m) {
      value -= found.middle_m[axis];
      farthest_m = std::max(farthest_m, std::abs(value));
    }
    const std::vector<Passage> passed = passages(time_s, value_m, noise_levels * noise_m[axis]);
    const bool is_clear = farthest_m > clear * noise_m[axis];
    if (passed.size() <= (is_clear ? fewest_of_clear : fewest_half_periods)) continue;
    std::vector<double> between_s, readings;
    double sum_m = 0.0, full_m = 0.0;
    for (size_t i = 1; i < passed.size(); ++i) {
      std::vector<double> sizes_m;
      for (size_t k = passed[i - 1].before; k < passed[i].before; ++k) {
        sizes_m.push_back(std::abs(value_m[k + 1]));
        sum_m += sizes_m.back();
      }
      // The quantile 0.9, because the upper tenth may contain outliers.
      std::ranges::sort(sizes_m);
      readings.push_back(static_cast<double>(sizes_m.size()));
      full_m += readings.back() * sizes_m[sizes_m.size() * 9 / 10];
      between_s.push_back(passed[i].time_s - passed[i - 1].time_s);
    }
    // The mean without periods that lack rows: a median would be as coarse as the rows.
    const double usual_s = upper_median(between_s);
    std::erase_if(between_s, [&](double s) { return std::abs(s - usual_s) > 0.3 * usual_s; });
    const auto count = static_cast<double>(between_s.size());
    const bool is_harmonic = count >= regular * static_cast<double>(readings.size()) &&
                             upper_median(readings) >= fewest_readings &&
                             sum_m > least_fullness * full_m;
    if (!is_harmonic || !(farthest_m > found.most_m)) continue;
    found.period_s = 2.0 * std::accumulate(between_s.begin(), between_s.end(), 0.0) / count;
    found.most_m = farthest_m;
  }
  return found.period_s > 0.0 ? std::optional(found) : std::nullopt;
}

bool has_no_mean_rate(const std::vector<Observation>& runs) {
  constexpr double none = 0.15;  // of the rms; tumbling bodies have 0.4 and more
  Vec3 sum = Vec3::Zero();
  double squares = 0.0, count = 0.0;
  for (const Observation& seen : runs) {
    for (const Vec3& rate : seen.gyro_rad_s) {
      if (!rate.allFinite()) continue;
      sum += rate;
      squares += rate.squaredNorm();
      ++count;
    }
  }
  return sum.squaredNorm() < none * none * squares * count;
}

std::optional<int> axis_of_swing(const std::vector<Observation>& runs, double across) {
  Mat3 squares = Mat3::Zero();
  for (const Observation& seen : runs) {
    for (const Vec3& rate : seen.gyro_rad_s) {
      if (rate.allFinite()) squares += rate * rate.transpose();
    }
  }
  const SymmetricEigen principal = symmetric_eigen(squares);
  if (!(principal.values.head(2).sum() < across * across * principal.values[2])) {
    return std::nullopt;
  }
  Eigen::Index largest = 0;
  principal.vectors.col(2).cwiseAbs().maxCoeff(&largest);
  return static_cast<int>(largest);
}

std::optional<int> only_axis(const std::vector<Observation>& runs) {
  Vec3 squares = Vec3::Zero();
  for (const Observation& seen : runs) {
    for (size_t i = 0; i < seen.blocks(); ++i) {
      if (seen.gyro_rad_s[i].allFinite()) squares += seen.gyro_rad_s[i].cwiseAbs2();
    }
  }
  int axis = 0;
  const double most = squares.maxCoeff(&axis);
  constexpr double across = 0.05;  // fraction of the rate: a slightly misaligned gyro
  if (squares.sum() - most > across * across * most) return std::nullopt;
  return axis;
}

}  // namespace photorque
