#include "inference/estimator/evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numerics/linear.h"
#include "inference/estimator/covariance.h"

namespace photorque::inference {

double log_evidence(const Fit& fit) {
  if (!std::isfinite(fit.chi2)) return -1e300;
  double result = -0.5 * fit.chi2 - 0.5 * fit.hessian.log_determinant();
  for (Eigen::Index i = 0; i < fit.parameters.size(); ++i) {
    const Parameter& p = fit.parameters[i];
    result += p.has_prior() ? -std::log(p.sigma) : 0.5 * std::log(2.0 * std::numbers::pi);
  }
  return result;
}

double log_strength_evidence(const Strengths& s, const Eigen::MatrixXd& covariance, size_t effects,
                             const Thresholds::Evidence& limits) {
  const auto n = static_cast<Eigen::Index>(s.at.size());
  if (n == 0) return 0.0;
  Eigen::MatrixXd C(n, n);
  Eigen::VectorXd theta(n);
  double result = 0.0;
  for (Eigen::Index a = 0; a < n; ++a) {
    const auto i = static_cast<size_t>(a);
    theta[a] = s.value[i] / s.scale[i];
    result -= std::log(s.scale[i]);
    for (Eigen::Index b = 0; b < n; ++b) {
      const auto j = static_cast<size_t>(b);
      C(a, b) = covariance(s.at[i], s.at[j]) / (s.scale[i] * s.scale[j]);
    }
  }
  if (!C.allFinite()) return -1e300;
  const int widths = limits.strength_widths;
  const auto width = [&](int k) {
    return std::pow(10.0, limits.first_log10_width + limits.step_log10_width * k);
  };
  std::vector<int> chosen(effects, widths - 3);
  const auto at = [&]() {
    Eigen::MatrixXd sum = C;
    for (Eigen::Index a = 0; a < n; ++a) {
      const double w = width(chosen[s.owner[static_cast<size_t>(a)]]);
      sum(a, a) += w * w;
    }
    return -0.5 * (log_determinant(sum) + squared_distance(theta, sum));
  };
  // Optimises the prior width of each effect in turn, with the other widths at their best values.
  for (const bool last : {false, true}) {
    for (size_t c = 0; c < effects; ++c) {
      std::vector<double> value;
      for (chosen[c] = 0; chosen[c] < widths; ++chosen[c]) value.push_back(at());
      const auto best = std::max_element(value.begin(), value.end());
      chosen[c] = static_cast<int>(best - value.begin());
      if (!last) continue;
      double mean = 0.0;
      for (const double v : value) mean += std::exp(v - *best) / widths;
      result += std::log(mean);
    }
  }
  return result + at();
}

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
