// The interface between the estimator and a model with parameters.
//
// A forward model predicts recordings ("runs") for parameters θ. The estimator has no access to
// recordings. It requests, for each run, sums over residuals whitened by their noise (NormalSums),
// and, for the whole, the parameters with their priors. A point θ is a vector of coordinates that
// only the model interprets. It may lie on a manifold, such as an attitude, whose four quaternion
// components have three degrees of freedom. The estimator therefore changes a point only through
// stepped(), with a step in the order of Parameters.
#pragma once

#include <functional>

#include "inference/estimator/arrow_matrix.h"
#include "inference/estimator/parameter.h"

namespace photorque::inference {

// Request for the evaluation of one run.
struct Request {
  bool derivatives = true;  // false: only χ² and samples are required
  double window = 1.0;      // only the first part of the run, as a fraction in (0, 1]
  // The model may abort a run whose χ² alone exceeds this, as if it could not be evaluated.
  double give_up_above = infinity;
};

class ForwardModel {
 public:
  virtual ~ForwardModel() = default;

  // All parameters at a point, with their priors. Names, bounds and widths are independent of the
  // point; the mean of a prior may depend on it. Only `value` is used of a parameter without prior
  // and bounds.
  virtual Parameters parameters(const Eigen::VectorXd& at) const = 0;

  // Sums of one run without priors: first over its run parameters, then over the shared ones.
  // Throws NumericalError where the model cannot be evaluated; χ² then counts as infinite.
  virtual NormalSums sums(const Eigen::VectorXd& at, Eigen::Index run,
                          const Request& request) const = 0;

  // The point after a step. A parameter that would pass a bound ends exactly on it.
  virtual Eigen::VectorXd stepped(const Eigen::VectorXd& at, const Eigen::VectorXd& step) const = 0;
};

// Sums of all runs and of the priors at a point.
struct Evaluation {
  SumsOfRuns sums;               // χ² is infinite where the model cannot be evaluated
  double data_chi2 = infinity;   // excluding the priors
  std::vector<double> run_chi2;  // one per run
};

// Evaluates all runs and the priors at a point. χ² is infinite if a run cannot be evaluated.
Evaluation evaluate(const ForwardModel& model, const Eigen::VectorXd& at, const Request& request);

// Forward models whose residuals are a plain function of the values of their parameters.

// Whitened residuals r = (measured − predicted)/noise of a run and, where `slopes` is not null,
// their slopes J = ∂(predicted/noise)/∂θ, one column per parameter. `values`: the run parameters,
// then the shared ones. Non-finite residuals count as infinite χ².
using ResidualFunction = std::function<void(const Eigen::VectorXd& values, Eigen::Index run,
                                            Eigen::VectorXd& residuals, Eigen::MatrixXd* slopes)>;

// A point is the vector of all values, in the order of Parameters.
class ResidualModel final : public ForwardModel {
 public:
  ResidualModel(Parameters parameters, ResidualFunction residuals);
  // A single run with all parameters shared.
  ResidualModel(std::vector<Parameter> parameters, ResidualFunction residuals);

  // The initial values of the parameters.
  Eigen::VectorXd start() const;

  Parameters parameters(const Eigen::VectorXd& at) const override;
  NormalSums sums(const Eigen::VectorXd& at, Eigen::Index run,
                  const Request& request) const override;
  Eigen::VectorXd stepped(const Eigen::VectorXd& at, const Eigen::VectorXd& step) const override;

 private:
  Parameters parameters_;
  ResidualFunction residuals_;
};

// Slopes by central differences with `step` (absolute: parameters are logarithms or of order one).
// The error is step² times the third derivative, plus 1e-16/step from rounding.
ResidualFunction with_differences(
    std::function<Eigen::VectorXd(const Eigen::VectorXd& values, Eigen::Index run)> residuals,
    double step = 1e-5);

}  // namespace photorque::inference
