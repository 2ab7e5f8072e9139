#include "inference/estimator/predictive.h"

#include <algorithm>

#include "inference/estimator/covariance.h"

namespace photorque::inference {

double expected_chi2_per_sample(const Fit& train, const Fit& joint) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (!train.hessian.all_finite() || !joint.hessian.all_finite()) return unknown;
  const Eigen::MatrixXd known = train.hessian.shared_information(),
                        of_all = joint.hessian.shared_information();
  if (known.rows() != of_all.rows()) return unknown;
  const double held = static_cast<double>(joint.samples - train.samples);
  const double carried = posterior_of(known).cwiseProduct(of_all - known).sum();
  // Both are taken where their own fit ended, so that a difference of none may be below it.
  return 1.0 + std::max(0.0, carried) / held;
}

}  // namespace photorque::inference
