#include "inference/estimator/forward_model.h"

#include <cmath>

#include "core/errors.h"

namespace photorque::inference {
namespace {

// Adds the sums of one run to those of all.
void scatter(const NormalSums& from, const Parameters& parameters, Eigen::Index run,
             NormalSums& to) {
  const Eigen::Index per_run = parameters.per_run(), first_shared = parameters.first_shared();
  const auto place = [&](Eigen::Index v) {
    return v < per_run ? run * per_run + v : first_shared + v - per_run;
  };
  const Eigen::Index count = from.gradient.size();
  for (Eigen::Index a = 0; a < count; ++a) {
    to.gradient[place(a)] += from.gradient[a];
    for (Eigen::Index b = 0; b < count; ++b) to.matrix(place(a), place(b)) += from.matrix(a, b);
  }
  to.chi2 += from.chi2;
  to.samples += from.samples;
}

void add_priors(const Parameters& parameters, NormalSums& sums) {
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    if (!p.has_prior()) continue;
    const double off = (p.mean - p.value) / p.sigma;
    sums.matrix(i, i) += 1.0 / (p.sigma * p.sigma);
    sums.gradient[i] += off / p.sigma;
    sums.chi2 += off * off;
  }
}

}  // namespace

Evaluation evaluate(const ForwardModel& model, const Eigen::VectorXd& at, const Request& request) {
  const Parameters parameters = model.parameters(at);
  const Eigen::Index size = parameters.size();
  Evaluation result;
  result.sums = {Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0.0, 0};
  try {
    for (Eigen::Index run = 0; run < parameters.runs(); ++run) {
      const NormalSums sums = model.sums(at, run, request);
      if (!std::isfinite(sums.chi2)) throw NumericalError("the residuals are not finite");
      result.run_chi2.push_back(sums.chi2);
      result.run_samples.push_back(sums.samples);
      if (request.derivatives) {
        scatter(sums, parameters, run, result.sums);
      } else {
        result.sums.chi2 += sums.chi2;
        result.sums.samples += sums.samples;
      }
    }
  } catch (const NumericalError&) {
    result.sums = {Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), infinity, 0};
    result.run_chi2.clear();
    result.run_samples.clear();
    return result;
  }
  result.data_chi2 = result.sums.chi2;
  add_priors(parameters, result.sums);
  return result;
}

}  // namespace photorque::inference
