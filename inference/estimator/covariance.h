// Covariance of fitted parameters, including parameters that the data do not determine.
//
// The information matrix H = Jᵀ J + Σ⁻¹ (data and priors) is the inverse of the covariance and half
// the second derivative of χ². If neither data nor priors determine some combination of parameters,
// H is singular and this combination has no covariance. The program has one policy: every parameter
// in such a combination is reported as UNDETERMINED. Its standard error is infinite, and along that
// combination it keeps its initial value. It never gets a zero error, or a large number that a
// reader may take for a measurement. All other parameters get their marginal covariance, whatever
// the undetermined ones are.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace photorque::inference {

struct Covariance {
  Eigen::MatrixXd matrix;  // undetermined parameters: infinite on the diagonal, zero elsewhere
  std::vector<Eigen::Index> undetermined;  // in ascending order

  bool is_determined(Eigen::Index i) const;
  double standard_error(Eigen::Index i) const;  // ≥ 0, infinite where undetermined
};

// Covariance from a symmetric information matrix. H is first scaled to a unit diagonal, because the
// units of the parameters may differ by any number of orders. A combination is undetermined where
// its scaled information is below 1e-14 per parameter, which is rounding of the sums (1e-7 for the
// singular values of J).
Covariance covariance_of(const Eigen::MatrixXd& information);

// The plain inverse of the information, for problems whose priors make it positive definite. It is
// always finite, and large if only a prior determines a combination.
Eigen::MatrixXd posterior_of(const Eigen::MatrixXd& information);

// ln |A| of a positive definite matrix whose rows have different units. Pivots are limited to at
// least 1e-12 of the diagonal because of rounding.
double log_determinant(const Eigen::MatrixXd& A);

}  // namespace photorque::inference
