// How well parameters are known, and which are not known at all.
//
// The information matrix H = Jᵀ J + Σ⁻¹ (of the data and of the priors) is the inverse of the
// covariance, and half the second derivative of χ². Where neither data nor prior say anything about
// some combination of parameters, H is singular and that combination has no covariance. The policy
// of this program is one: every parameter that takes part in such a combination is UNDETERMINED. It
// is named, its standard error is infinite, and along that combination it stays where the fit
// began. It never gets an error of zero, nor a large number that a reader might take for a
// measurement; all others get their marginal covariance, whatever the undetermined ones may be.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace photorque::inference {

struct Covariance {
  Eigen::MatrixXd matrix;  // of undetermined ones: infinite on the diagonal, zero elsewhere
  std::vector<Eigen::Index> undetermined;  // rising

  bool is_determined(Eigen::Index i) const;
  double standard_error(Eigen::Index i) const;  // ≥ 0, infinite where undetermined
};

// Of a symmetric information matrix. Parameters may have units that differ by any number of orders:
// H is scaled to a unit diagonal first. A combination counts as undetermined where its information
// is below 1e-14 of that per parameter: the remainder is rounding of the sums. (In terms of
// the singular values of J, 1e-7.)
Covariance covariance_of(const Eigen::MatrixXd& information);

// The inverse of the information as it stands, for problems whose priors make it positive definite:
// always finite, and large where a prior alone holds a combination.
Eigen::MatrixXd posterior_of(const Eigen::MatrixXd& information);

// ln |A| of a positive definite matrix whose rows have different units. What rounding has made
// smaller than 1e-12 of the diagonal counts as that.
double log_determinant(const Eigen::MatrixXd& A);

}  // namespace photorque::inference
