// The interface between the estimator and a model with parameters.
//
// A forward model predicts recordings ("runs") for parameters θ. The estimator never sees a
// recording; of every run it asks for sums over the residuals, whitened by their noise
// (NormalSums), and of the whole for the parameters' priors. A point θ is a vector of coordinates
// that the model alone understands: a parameter may live on a manifold, as an attitude does, whose
// four quaternion components move along three directions. What the estimator adds to a point is a
// step, in the order of Parameters, through stepped().
#pragma once

#include <functional>

#include "inference/estimator/arrow_matrix.h"
#include "inference/estimator/parameter.h"

namespace photorque::inference {

// Request for the evaluation of one run.
struct Request {
  bool derivatives = true;  // false: χ² and the number of samples suffice
  double window = 1.0;      // only the first part of the run, as a fraction in (0, 1]
  // A run whose χ² alone exceeds this may be given up as if it could not be evaluated.
  double give_up_above = infinity;
};

class ForwardModel {
 public:
  virtual ~ForwardModel() = default;

  // All parameters where they stand at a point, with their priors. Names, bounds and widths do not
  // depend on the point; the mean of a prior may. Nothing but `value` is used of a parameter
  // without prior and bounds.
  virtual Parameters parameters(const Eigen::VectorXd& at) const = 0;

  // The sums of one run, priors left out: by the parameters of that run, then the shared ones.
  // NumericalError where the model cannot be evaluated, which counts as infinitely bad.
  virtual NormalSums sums(const Eigen::VectorXd& at, Eigen::Index run,
                          const Request& request) const = 0;

  // The point that a step leads to. A parameter that the step takes past a bound ends on it
  // exactly.
  virtual Eigen::VectorXd stepped(const Eigen::VectorXd& at, const Eigen::VectorXd& step) const = 0;
};

// The sums of all runs and of the priors at a point.
struct Evaluation {
  SumsOfRuns sums;                   // χ² is infinite where the model cannot be evaluated
  double data_chi2 = infinity;       // without the priors
  std::vector<double> run_chi2;      // of each run
  std::vector<int64_t> run_samples;  // of each run
};

Evaluation evaluate(const ForwardModel& model, const Eigen::VectorXd& at, const Request& request);

// Forward models whose residuals are a plain function of their parameters' values.

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
