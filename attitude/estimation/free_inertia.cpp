#include "attitude/estimation/free_inertia.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/numerics/linear.h"

namespace photorque {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr size_t fewest_rows = 20;

// The complete rates of one segment, and the speeds of the wheels at these times.
struct RatesOfPiece {
  std::vector<double> time_s;
  std::vector<Vec3> rate_rad_s, wheel_rad_s;
};

RatesOfPiece rates_of_piece(const Observation& seen) {
  RatesOfPiece rates;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    if (!(seen.gyro_rows[i].array() > 0.0).all()) continue;
    const double time_s = seen.time_s[i];
    rates.time_s.push_back(time_s);
    rates.rate_rad_s.push_back(seen.gyro_rad_s[i]);
    rates.wheel_rad_s.push_back(seen.schedule.at(time_s).wheel.at(time_s));
  }
  return rates;
}

bool is_commanded_torque(const Schedule& schedule) {
  return std::ranges::any_of(schedule.held, &ZeroOrderHold::commands_torque);
}

// Integral from the first time to each time, by the trapezoidal rule with the Euler–Maclaurin
// correction by the slopes. The error is of fourth order in the interval.
std::vector<Vec3> integral(const std::vector<double>& time_s, const std::vector<Vec3>& of) {
  const size_t n = of.size();
  const auto slope = [&](size_t i) -> Vec3 {
    const size_t before = i > 0 ? i - 1 : 0, after = std::min(n - 1, i + 1);
    return (of[after] - of[before]) / (time_s[after] - time_s[before]);
  };
  std::vector<Vec3> sum(n, Vec3::Zero());
  for (size_t i = 1; i < n; ++i) {
    const double step_s = time_s[i] - time_s[i - 1];
    sum[i] = sum[i - 1] + 0.5 * step_s * (of[i] + of[i - 1]) -
             step_s * step_s / 12.0 * (slope(i) - slope(i - 1));
  }
  return sum;
}

// The conserved momentum per unit of one unknown, minus its mean, because the constant is free.
VectorXd column_of(const std::vector<double>& time_s, const std::vector<Vec3>& momentum,
                   const std::vector<Vec3>& torque) {
  const std::vector<Vec3> turned = integral(time_s, torque);
  const auto n = static_cast<Index>(time_s.size());
  VectorXd column(3 * n);
  for (Index i = 0; i < n; ++i) {
    const auto row = static_cast<size_t>(i);
    column.segment<3>(3 * i) = momentum[row] + turned[row];
  }
  for (Index k = 0; k < 3; ++k) {
    auto axis = column(Eigen::seqN(k, n, 3));
    axis.array() -= axis.mean();
  }
  return column;
}

Mat3 unit_inertia(Index k) {
  constexpr std::array<std::array<int, 2>, 6> at = {
      {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  const auto [i, j] = at[static_cast<size_t>(k)];
  Mat3 unit = Mat3::Zero();
  unit(i, j) = unit(j, i) = 1.0;
  return unit;
}

constexpr Index wheel = 6, drag = 9, unknowns = 12;

// All columns of a segment; those of an unmeasured wheel are zero.
MatrixXd columns_of(const RatesOfPiece& rates) {
  const size_t n = rates.time_s.size();
  MatrixXd columns(3 * static_cast<Index>(n), unknowns);
  std::vector<Vec3> momentum(n), torque(n);
  const auto put = [&](Index at, const auto& momentum_of) {
    for (size_t i = 0; i < n; ++i) {
      momentum[i] = momentum_of(i);
      torque[i] = rates.rate_rad_s[i].cross(momentum[i]);
    }
    columns.col(at) = column_of(rates.time_s, momentum, torque);
  };
  for (Index k = 0; k < wheel; ++k) {
    const Mat3 unit = unit_inertia(k);
    put(k, [&](size_t i) -> Vec3 { return unit * rates.rate_rad_s[i]; });
  }
  for (Index k = 0; k < 3; ++k) {
    put(wheel + k, [&](size_t i) -> Vec3 { return rates.wheel_rad_s[i][k] * Vec3::Unit(k); });
    for (size_t i = 0; i < n; ++i) {
      const Vec3& rate = rates.rate_rad_s[i];
      momentum[i] = Vec3::Zero();
      torque[i] = rate.norm() * rate[k] * Vec3::Unit(k);
    }
    columns.col(drag + k) = column_of(rates.time_s, momentum, torque);
  }
  return columns;
}

Mat3 matrix_of(const InertiaNumbers& six) {
  Mat3 inertia = Mat3::Zero();
  for (Index k = 0; k < 6; ++k) inertia += six[k] * unit_inertia(k);
  return inertia;
}

std::vector<Vec3> about_mean(std::vector<Vec3> rates) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& rate : rates) mean += rate / static_cast<double>(rates.size());
  for (Vec3& rate : rates) rate -= mean;
  return rates;
}

// Correlation length of the residuals in rows, at least one: the largest of the three axes. The
// segments follow one another.
double alike_rows(const VectorXd& residual) {
  double longest = 1.0;
  const Index n = residual.size() / 3;
  for (Index k = 0; k < 3; ++k) {
    const VectorXd r = residual(Eigen::seqN(k, n, 3));
    const double all = r.squaredNorm();
    double rows = 1.0;
    for (Index lag = 1; all > 0.0 && lag < n / 3; ++lag) {
      constexpr double none = 0.05;
      const double rho = r.head(n - lag).dot(r.tail(n - lag)) / all;
      if (rho < none) break;
      rows += 2.0 * rho;
    }
    longest = std::max(longest, rows);
  }
  return longest;
}

}  // namespace

std::optional<FreeInertia> free_inertia(const std::vector<Observation>& pieces, FreeDrag drags) {
  constexpr size_t most_rows = 6000;
  std::vector<MatrixXd> parts;
  std::vector<Vec3> rates_rad_s;
  Index rows = 0;
  for (const Observation& seen : pieces) {
    if (is_commanded_torque(seen.schedule)) return std::nullopt;
    const RatesOfPiece rates = rates_of_piece(seen.averaged(most_rows));
    if (rates.time_s.size() < fewest_rows) continue;
    parts.push_back(columns_of(rates));
    rows += parts.back().rows();
    const std::vector<Vec3> changes = about_mean(rates.rate_rad_s);
    rates_rad_s.insert(rates_rad_s.end(), changes.begin(), changes.end());
  }
  if (parts.empty()) return std::nullopt;
  MatrixXd all(rows, unknowns);
  Index next = 0;
  for (const MatrixXd& part : parts) {
    all.middleRows(next, part.rows()) = part;
    next += part.rows();
  }
  // The moment with the largest column is known best, so it is the unit of all others.
  Index unit = 0;
  all.leftCols<3>().colwise().norm().maxCoeff(&unit);
  std::vector<Index> free;
  const Index last = drags == FreeDrag::fitted ? unknowns : drag;
  for (Index k = 0; k < last; ++k) {
    if (k != unit && all.col(k).norm() > 0.0) free.push_back(k);
  }
  // Columns of unit length, so that no result depends on units.
  MatrixXd X = all(Eigen::all, free);
  const VectorXd length = X.colwise().norm();
  X = X * length.cwiseInverse().asDiagonal();
  const VectorXd y = -all.col(unit);
  const LeastSquares fit = least_squares(X, y);
  if (fit.rank < X.cols()) return std::nullopt;
  const VectorXd solved = fit.solution;
  const VectorXd residual = y - X * solved;
  const auto freedom = static_cast<double>(std::max<Index>(1, X.rows() - X.cols()));
  const MatrixXd covariance =
      (X.transpose() * X).inverse() * (residual.squaredNorm() / freedom * alike_rows(residual));
  // All six numbers in units of that moment, then in units of their mean moment.
  InertiaNumbers in_units = InertiaNumbers::Zero();
  Eigen::Matrix<double, 6, 6> spread = Eigen::Matrix<double, 6, 6>::Zero();
  FreeInertia result;
  in_units[unit] = 1.0;
  for (size_t a = 0; a < free.size(); ++a) {
    const auto i = static_cast<Index>(a);
    if (free[a] >= wheel && free[a] < drag) {
      result.wheel[free[a] - wheel] = solved[i] / length[i];
      result.wheel_sigma[free[a] - wheel] = std::sqrt(covariance(i, i)) / length[i];
    }
    if (free[a] >= wheel) continue;
    in_units[free[a]] = solved[i] / length[i];
    for (size_t b = 0; b < free.size(); ++b) {
      if (free[b] >= wheel) continue;
      const auto j = static_cast<Index>(b);
      spread(free[a], free[b]) = covariance(i, j) / (length[i] * length[j]);
    }
  }
  if (!(in_units.head<3>().minCoeff() > 0.0)) return std::nullopt;
  const double mean = in_units.head<3>().sum() / 3.0;
  result.value = in_units / mean;
  result.wheel /= mean;
  result.wheel_sigma /= mean;
  Eigen::Matrix<double, 6, 6> slope = Eigen::Matrix<double, 6, 6>::Identity();
  slope.leftCols<3>().colwise() -= result.value / 3.0;
  result.covariance = slope * spread * slope.transpose() / (mean * mean);
  double change2 = 0.0;
  for (const Vec3& rate : rates_rad_s) change2 += (matrix_of(in_units) * rate).squaredNorm();
  result.left = residual.norm() / std::sqrt(change2);
  return result;
}

}  // namespace photorque
