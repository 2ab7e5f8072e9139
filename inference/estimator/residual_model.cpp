#include "inference/estimator/residual_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/errors.h"

namespace photorque::inference {

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
    std::function<Eigen::VectorXd(const Eigen::VectorXd& values)> residuals, double step) {
  return [residuals = std::move(residuals), step](const Eigen::VectorXd& values, Eigen::Index,
                                                  Eigen::VectorXd& at, Eigen::MatrixXd* slopes) {
    at = residuals(values);
    if (slopes == nullptr) return;
    slopes->resize(at.size(), values.size());
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      Eigen::VectorXd low = values, high = values;
      low[k] -= step;
      high[k] += step;
      slopes->col(k) = (residuals(low) - residuals(high)) / (2.0 * step);
    }
  };
}

}  // namespace photorque::inference
