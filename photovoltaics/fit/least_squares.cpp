#include "photovoltaics/fit/least_squares.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace photorque {
namespace {

constexpr int max_rounds = 300;
constexpr double min_damping = 1e-14, max_damping = 1e10;

struct Linearised {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  double squares = 0.0;
};

Linearised linearise(const ResidualFunction& function, const Eigen::VectorXd& parameters) {
  Linearised at;
  function(parameters, at.residuals, at.jacobian);
  at.squares = at.residuals.squaredNorm();
  return at;
}

Eigen::VectorXd damped_step(const Linearised& at, const Eigen::VectorXd& scale, double damping) {
  const Eigen::Index rows = at.jacobian.rows(), columns = at.jacobian.cols();
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(rows + columns, columns);
  both.topRows(rows) = at.jacobian * scale.cwiseInverse().asDiagonal();
  both.bottomRows(columns).diagonal().setConstant(std::sqrt(damping));
  Eigen::VectorXd wanted = Eigen::VectorXd::Zero(rows + columns);
  wanted.head(rows) = -at.residuals;
  return both.colPivHouseholderQr().solve(wanted).cwiseQuotient(scale);
}

// Columns scaled to length one: parameters differ by many orders of magnitude.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& jacobian) {
  const Eigen::VectorXd scale =
      jacobian.colwise().norm().transpose().unaryExpr([](double x) { return x > 0 ? x : 1.0; });
  const Eigen::MatrixXd scaled = jacobian * scale.cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinV);
  Eigen::VectorXd inverse = svd.singularValues();
  const double smallest = 1e-13 * inverse.maxCoeff();
  for (double& s : inverse) s = s > smallest ? 1.0 / (s * s) : 0.0;
  const Eigen::MatrixXd v = scale.cwiseInverse().asDiagonal() * svd.matrixV();
  return v * inverse.asDiagonal() * v.transpose();
}

}  // namespace

double LeastSquaresFit::variance() const {
  const Eigen::Index freedom = residuals - parameters.size();
  return freedom > 0 ? squares / static_cast<double>(freedom) : 0.0;
}

ResidualFunction with_differences(std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residuals,
                                  double step) {
  return [residuals = std::move(residuals), step](
             const Eigen::VectorXd& parameters, Eigen::VectorXd& value, Eigen::MatrixXd& jacobian) {
    value = residuals(parameters);
    jacobian.resize(value.size(), parameters.size());
    for (Eigen::Index k = 0; k < parameters.size(); ++k) {
      Eigen::VectorXd low = parameters, high = parameters;
      low[k] -= step;
      high[k] += step;
      jacobian.col(k) = (residuals(high) - residuals(low)) / (2.0 * step);
    }
  };
}

LeastSquaresFit least_squares(const Eigen::VectorXd& start, const ResidualFunction& function) {
  Eigen::VectorXd parameters = start;
  Linearised at = linearise(function, parameters);
  Eigen::VectorXd scale = Eigen::VectorXd::Constant(start.size(), 1e-300);
  double damping = 1e-3;
  for (int round = 0; round < max_rounds && damping < max_damping && at.squares > 0; ++round) {
    scale = scale.cwiseMax(at.jacobian.colwise().norm().transpose());
    const Eigen::VectorXd step = damped_step(at, scale, damping);
    const Eigen::VectorXd trial = parameters + step;
    Linearised next = linearise(function, trial);
    if (!(next.squares < at.squares) || !next.jacobian.allFinite()) {
      damping = std::max(10.0 * damping, 1e-8);
      continue;
    }
    const bool still = at.squares - next.squares <= 1e-14 * at.squares;
    parameters = trial;
    at = std::move(next);
    damping = std::max(0.1 * damping, min_damping);
    if (still) break;
  }
  return {parameters, pseudo_inverse(at.jacobian), at.squares, at.residuals.size()};
}

}  // namespace photorque
