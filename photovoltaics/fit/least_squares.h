// Nonlinear least squares for a handful of parameters.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace photorque {

struct LeastSquaresFit {
  Eigen::VectorXd parameters;
  Eigen::MatrixXd covariance;  // (JᵀJ)⁺ at the solution: for residuals of unit variance
  double squares = 0.0;        // rᵀr
  Eigen::Index residuals = 0;

  // Variance per degree of freedom; 1 where the residuals are as large as they were said to be.
  double variance() const;
};

// Writes residuals and their derivatives by the parameters.
using ResidualFunction = std::function<void(const Eigen::VectorXd& parameters,
                                            Eigen::VectorXd& residuals, Eigen::MatrixXd& jacobian)>;

// Derivatives by central differences of `step` (absolute: parameters are logarithms, or of order
// one); good to step².
ResidualFunction with_differences(std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residuals,
                                  double step = 1e-5);

// K. Levenberg, D. Marquardt: min |J δ + r|² + λ |D δ|², solved by QR, with D the largest column
// norms met so far (J. J. Moré, Lecture Notes in Mathematics 630, 105 (1978)). Ends when no step
// lowers the sum any more, so that exact data are fitted to rounding. Residuals that are not finite
// count as a step too far.
LeastSquaresFit least_squares(const Eigen::VectorXd& start, const ResidualFunction& function);

}  // namespace photorque
