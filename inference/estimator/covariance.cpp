#include "inference/estimator/covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/numerics/linear.h"
#include "inference/estimator/parameter.h"

namespace photorque::inference {
namespace {

constexpr double rounding = 1e-14;  // limit of the information on a unit diagonal, per parameter

// Marginal covariance of the determined combinations. `scaled` has a unit diagonal. If all
// parameters are determined, the matrix is left empty.
Covariance without_unknown(const Eigen::MatrixXd& scaled) {
  const Eigen::Index n = scaled.rows();
  const SymmetricEigen eigen = symmetric_eigen(scaled);
  const double least = rounding * static_cast<double>(n);
  // Squared projection of each parameter onto the undetermined combinations.
  Eigen::VectorXd unknown = Eigen::VectorXd::Zero(n), inverse = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    if (eigen.values[k] > least) {
      inverse[k] = 1.0 / eigen.values[k];
    } else {
      unknown += eigen.vectors.col(k).cwiseAbs2();
    }
  }
  Covariance result;
  if (unknown.isZero(0.0)) return result;
  result.matrix = eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose();
  // The error of an eigenvector is rounding divided by the gap between eigenvalues.
  constexpr double takes_part = 1e-6;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (unknown[i] < takes_part * takes_part) continue;
    result.undetermined.push_back(i);
    result.matrix.row(i).setZero();
    result.matrix.col(i).setZero();
    result.matrix(i, i) = infinity;
  }
  return result;
}

}  // namespace

bool Covariance::is_determined(Eigen::Index i) const {
  return !std::binary_search(undetermined.begin(), undetermined.end(), i);
}

double Covariance::standard_error(Eigen::Index i) const {
  const double variance = matrix(i, i);
  return variance >= 0.0 ? std::sqrt(variance) : infinity;
}

Covariance covariance_of(const Eigen::MatrixXd& information) {
  if (!information.allFinite()) {
    Covariance nothing{Eigen::MatrixXd::Zero(information.rows(), information.cols()), {}};
    nothing.matrix.diagonal().setConstant(infinity);
    for (Eigen::Index i = 0; i < information.rows(); ++i) nothing.undetermined.push_back(i);
    return nothing;
  }
  const Eigen::VectorXd scale = inverse_roots(information.diagonal());
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> ldlt = scaled.ldlt();
  // The smallest pivot bounds the smallest eigenvalue from above and, except for contrived
  // matrices, exceeds it by at most a factor of the matrix size. If it is far from zero, no
  // eigenvalues are needed.
  constexpr double surely_known = 1e-9;
  Covariance result;
  if (ldlt.vectorD().size() > 0 && !(ldlt.vectorD().minCoeff() > surely_known)) {
    result = without_unknown(scaled);
  }
  if (result.undetermined.empty()) {
    result.matrix = ldlt.solve(Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols()));
  }
  result.matrix = Eigen::MatrixXd(scale.asDiagonal() * result.matrix * scale.asDiagonal());
  return result;
}

Eigen::MatrixXd posterior_of(const Eigen::MatrixXd& information) {
  const Eigen::VectorXd scale = inverse_roots(information.diagonal());
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::MatrixXd inverse =
      solve_symmetric(scaled, Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols()));
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

double log_determinant(const Eigen::MatrixXd& A) {
  // Parameters without information have no scale.
  const Eigen::VectorXd scale = (A.diagonal().array() > 0.0).select(A.diagonal().cwiseSqrt(), 1.0);
  const Eigen::MatrixXd scaled =
      scale.cwiseInverse().asDiagonal() * A * scale.cwiseInverse().asDiagonal();
  return scaled.ldlt().vectorD().cwiseMax(1e-12).array().log().sum() +
         2.0 * scale.array().log().sum();
}

}  // namespace photorque::inference
