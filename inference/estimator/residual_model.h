// Forward models whose residuals are a plain function of their parameters' values.
#pragma once

#include <functional>

#include "inference/estimator/forward_model.h"

namespace photorque::inference {

// Whitened residuals r = (measured − predicted)/noise of a run and, where `slopes` is not null,
// their slopes J = ∂(predicted/noise)/∂θ, a column for each parameter. `values`: the run's own
// parameters, then the shared ones. Residuals that are not finite count as infinitely bad.
using ResidualFunction = std::function<void(const Eigen::VectorXd& values, Eigen::Index run,
                                            Eigen::VectorXd& residuals, Eigen::MatrixXd* slopes)>;

// A point is the vector of all values, in the order of Parameters.
class ResidualModel final : public ForwardModel {
 public:
  ResidualModel(Parameters parameters, ResidualFunction residuals);
  // One run, all parameters shared.
  ResidualModel(std::vector<Parameter> parameters, ResidualFunction residuals);

  // The values that the parameters were given with.
  Eigen::VectorXd start() const;

  Parameters parameters(const Eigen::VectorXd& at) const override;
  NormalSums sums(const Eigen::VectorXd& at, Eigen::Index run,
                  const Request& request) const override;
  Eigen::VectorXd stepped(const Eigen::VectorXd& at, const Eigen::VectorXd& step) const override;

 private:
  Parameters parameters_;
  ResidualFunction residuals_;
};

// Slopes by central differences of `step` (absolute: parameters are logarithms, or of order one);
// good to step² times the third derivative, and to 1e-16/step.
ResidualFunction with_differences(
    std::function<Eigen::VectorXd(const Eigen::VectorXd& values)> residuals, double step = 1e-5);

}  // namespace photorque::inference
