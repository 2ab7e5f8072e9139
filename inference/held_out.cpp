#include "inference/held_out.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace photorque::inference {

HeldOutPrediction predict_held_out(const Fit& train, const Fit& joint) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (!train.hessian.all_finite() || !joint.hessian.all_finite()) return {unknown, unknown};
  const Eigen::MatrixXd known = train.hessian.shared_information(),
                        of_all = joint.hessian.shared_information();
  if (known.rows() != of_all.rows()) return {unknown, unknown};
  const double held = static_cast<double>(joint.samples - train.samples);
  const Eigen::MatrixXd carried = posterior_of(known) * (of_all - known);
  // The two matrices are from different fits, so a difference of zero may be slightly negative.
  const double mean = std::max(0.0, carried.trace()),
               square = std::max(0.0, carried.cwiseProduct(carried.transpose()).sum());
  return {1.0 + mean / held, std::sqrt(2.0 * (held + 2.0 * mean + square)) / held};
}

double held_out_sigma(const Fit& train, const Fit& joint, double chi2_per_sample, double noise) {
  const HeldOutPrediction expected = predict_held_out(train, joint);
  const double mean = noise * expected.chi2_per_sample,
               of_noise = mean * std::sqrt(2.0 / static_cast<double>(train.samples));
  return (chi2_per_sample - mean) / std::hypot(noise * expected.standard_error, of_noise);
}

}  // namespace photorque::inference
