#include "core/numerics/linear.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <limits>

namespace photorque {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd solve_symmetric(const MatrixXd& A, const MatrixXd& B) {
  return A.ldlt().solve(B);
}

double squared_distance(const VectorXd& x, const MatrixXd& C) {
  const VectorXd unit = C.diagonal().cwiseSqrt().cwiseInverse();
  const VectorXd scaled = unit.cwiseProduct(x);
  return scaled.dot(solve_symmetric(unit.asDiagonal() * C * unit.asDiagonal(), scaled).col(0));
}

LeastSquares least_squares(const MatrixXd& A, const MatrixXd& B, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> factors;
  if (threshold > 0.0) factors.setThreshold(threshold);
  factors.compute(A);
  return {factors.solve(B), factors.rank()};
}

SymmetricEigen symmetric_eigen(const MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(A);
  if (solver.info() != Eigen::Success) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    return {VectorXd::Constant(A.rows(), none), MatrixXd::Constant(A.rows(), A.cols(), none)};
  }
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace photorque
