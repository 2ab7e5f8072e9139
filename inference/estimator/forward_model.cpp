#include "inference/estimator/forward_model.h"

#include <cmath>

#include "core/errors.h"

namespace photorque::inference {
namespace {

// Adds the sums of one run to those of all.
void scatter(const NormalSums& from, const Parameters& parameters, Eigen::Index run,
             SumsOfRuns& to) {
  const Eigen::Index per_run = parameters.per_run();
  const Eigen::Index shared = from.gradient.size() - per_run;
  to.matrix.add(run, from.matrix);
  to.gradient.segment(run * per_run, per_run) += from.gradient.head(per_run);
  to.gradient.tail(shared) += from.gradient.tail(shared);
  to.chi2 += from.chi2;
  to.samples += from.samples;
}

void add_priors(const Parameters& parameters, SumsOfRuns& sums) {
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    if (!p.has_prior()) continue;
    const double off = (p.mean - p.value) / p.sigma;
    sums.matrix.add_to_diagonal(i, 1.0 / (p.sigma * p.sigma));
    sums.gradient[i] += off / p.sigma;
    sums.chi2 += off * off;
  }
}

SumsOfRuns no_sums(const Parameters& parameters, double chi2) {
  const Eigen::Index shared = parameters.size() - parameters.first_shared();
  return {ArrowMatrix(parameters.runs(), parameters.per_run(), shared),
          Eigen::VectorXd::Zero(parameters.size()), chi2, 0};
}

}  // namespace

Evaluation evaluate(const ForwardModel& model, const Eigen::VectorXd& at, const Request& request) {
  const Parameters parameters = model.parameters(at);
  Evaluation result;
  result.sums = no_sums(parameters, 0.0);
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
    result.sums = no_sums(parameters, infinity);
    result.run_chi2.clear();
    result.run_samples.clear();
    return result;
  }
  result.data_chi2 = result.sums.chi2;
  add_priors(parameters, result.sums);
  return result;
}

}  // namespace photorque::inference
