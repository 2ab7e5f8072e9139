// Least squares of one model to several observations at once: shared parameters, an initial state
// (and, where asked for, instrument biases) for every run.
//
// Gauss–Newton with Marquardt's damping on exact derivatives. What minimises is
//   χ² = Σ |r|² + Σ ((θ − θ₀)/σ)²,
// the negative log posterior times two, so that its Hessian is the inverse covariance.
#pragma once

#include <limits>
#include <vector>

#include "diagnosis/attitude/prediction.h"

namespace photorque {

// A parameter to be fitted, with its Gaussian prior.
struct Free {
  size_t disturbance = 0;
  int parameter = 0;
  double mean = 0.0;
  double sigma = std::numeric_limits<double>::infinity();  // > 0
  bool per_run = false;                                    // every run has its own value
  // The fit does not leave these.
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
};

struct RunStart {
  PlatformState initial;
  std::vector<double> own;  // values of the per-run parameters, in their order in Hypothesis::free
};

// A model with its free parameters at their present values.
struct Hypothesis {
  AttitudeModel model;  // shared parameters live in it; its schedule is replaced by each run's
  std::vector<Free> free;
  std::vector<RunStart> runs;

  double& value(const Free& f) {
    return model.disturbances[f.disturbance].parameters[static_cast<size_t>(f.parameter)].value;
  }
  // The model of one run: its schedule and its own parameters.
  AttitudeModel model_of(size_t run, const Observation& seen) const;
};

struct Fit {
  Hypothesis best;
  double chi2 = 0.0;       // with the priors
  double data_chi2 = 0.0;  // without
  int64_t samples = 0;
  // Of all variables: per run its initial state and own parameters, then the shared parameters.
  Eigen::MatrixXd hessian;
  Eigen::Index first_shared = 0;
  std::vector<double> run_chi2;
  std::vector<int64_t> run_samples;
  bool converged = false;

  double chi2_per_sample() const { return data_chi2 / static_cast<double>(samples); }
  // Covariance of the shared parameters, in their order.
  Eigen::MatrixXd shared_covariance() const;
};

struct FitSettings {
  std::vector<double> windows = {1.0};  // fractions of each run that are fitted in turn
  int max_iterations = 25;
  double tolerance = 1e-7;       // of the propagation
  double converged_gain = 0.01;  // stop when a step improves χ² by less
};

// A start of every run from what was seen at its beginning.
PlatformState first_state(const AttitudeModel& model, const Observation& seen);

// Such starts of all runs, their own parameters at the nominal model.
std::vector<RunStart> seen_starts(const Hypothesis& h, const std::vector<Observation>& runs);

// Never throws for a model that cannot be propagated at the start: then chi2 is infinite.
Fit fit(const Hypothesis& start, const std::vector<Observation>& runs,
        const FitSettings& settings = {});

// The sums of all runs at the present values, without fitting: variables as in Fit::hessian, and
// then `extra`, parameters of the model that are not free. With the priors of what is free.
NormalSums sums_at(const Hypothesis& at, const std::vector<Observation>& runs,
                   const std::vector<Free>& extra, double tolerance = 1e-7);

}  // namespace photorque
