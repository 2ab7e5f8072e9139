#include "inference/estimator/forward_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

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
    return result;
  }
  result.data_chi2 = result.sums.chi2;
  add_priors(parameters, result.sums);
  return result;
}

ResidualModel::ResidualModel(Parameters parameters, ResidualFunction residuals)
    : parameters_(std::move(parameters)), residuals_(std::move(residuals)) {}

ResidualModel::ResidualModel(std::vector<Parameter> parameters, ResidualFunction residuals)
    : ResidualModel(Parameters{{{}}, std::move(parameters)}, std::move(residuals)) {}

Eigen::VectorXd ResidualModel::start() const {
  Eigen::VectorXd values(parameters_.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = parameters_[i].value;
  return values;
}

Parameters ResidualModel::parameters(const Eigen::VectorXd& at) const {
  Parameters result = parameters_;
  Eigen::Index i = 0;
  for (std::vector<Parameter>& run : result.of_run) {
    for (Parameter& p : run) p.value = at[i++];
  }
  for (Parameter& p : result.shared) p.value = at[i++];
  return result;
}

NormalSums ResidualModel::sums(const Eigen::VectorXd& at, Eigen::Index run,
                               const Request& request) const {
  const Eigen::Index own = parameters_.per_run();
  const Eigen::Index shared = at.size() - parameters_.first_shared();
  Eigen::VectorXd values(own + shared);
  values << at.segment(run * own, own), at.tail(shared);
  Eigen::VectorXd residuals;
  Eigen::MatrixXd slopes;
  residuals_(values, run, residuals, request.derivatives ? &slopes : nullptr);
  const auto rows = std::max<Eigen::Index>(
      std::min<Eigen::Index>(1, residuals.size()),
      static_cast<Eigen::Index>(
          std::floor(request.window * static_cast<double>(residuals.size()))));
  const auto r = residuals.head(rows);
  if (!r.allFinite()) throw NumericalError("the residuals are not finite");
  NormalSums sums{{}, {}, r.squaredNorm(), rows};
  if (request.derivatives) {
    const auto J = slopes.topRows(rows);
    if (!J.allFinite()) throw NumericalError("the derivatives are not finite");
    sums.matrix = J.transpose() * J;
    sums.gradient = J.transpose() * r;
  }
  return sums;
}

Eigen::VectorXd ResidualModel::stepped(const Eigen::VectorXd& at,
                                       const Eigen::VectorXd& step) const {
  Eigen::VectorXd result = at + step;
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    result[i] = std::clamp(result[i], parameters_[i].lowest, parameters_[i].highest);
  }
  return result;
}

ResidualFunction with_differences(
    std::function<Eigen::VectorXd(const Eigen::VectorXd& values, Eigen::Index run)> residuals,
    double step) {
  return [residuals = std::move(residuals), step](const Eigen::VectorXd& values, Eigen::Index run,
                                                  Eigen::VectorXd& at, Eigen::MatrixXd* slopes) {
    at = residuals(values, run);
    if (slopes == nullptr) return;
    slopes->resize(at.size(), values.size());
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      Eigen::VectorXd low = values, high = values;
      low[k] -= step;
      high[k] += step;
      slopes->col(k) = (residuals(low, run) - residuals(high, run)) / (2.0 * step);
    }
  };
}

}  // namespace photorque::inference
