// Parameters of a fit with their priors and bounds.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "inference/estimator/arrow_matrix.h"

namespace photorque::inference {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// One number to be estimated.
struct Parameter {
  std::string name;
  std::string unit;    // empty where it has none, or where the name ends in it
  double value = 0.0;  // where it stands now
  // The Gaussian prior N(mean, sigma²). An infinite sigma is no prior at all.
  double mean = 0.0;
  double sigma = infinity;  // > 0
  // The fit does not leave these; lowest < highest.
  double lowest = -infinity;
  double highest = infinity;

  bool has_prior() const { return sigma < infinity; }
};

// All parameters of a problem, in the one order that steps, gradients and matrices use: those of
// the first run, those of the second, …, then those that all runs share. Every run has as many.
struct Parameters {
  std::vector<std::vector<Parameter>>
      of_run;  // nuisances: where a run began, its instrument's bias
  std::vector<Parameter> shared;

  Eigen::Index runs() const { return static_cast<Eigen::Index>(of_run.size()); }
  Eigen::Index per_run() const {
    return of_run.empty() ? 0 : static_cast<Eigen::Index>(of_run.front().size());
  }
  Eigen::Index first_shared() const { return runs() * per_run(); }
  Eigen::Index size() const { return first_shared() + static_cast<Eigen::Index>(shared.size()); }

  const Parameter& operator[](Eigen::Index i) const {
    if (i >= first_shared()) return shared[static_cast<size_t>(i - first_shared())];
    return of_run[static_cast<size_t>(i / per_run())][static_cast<size_t>(i % per_run())];
  }
};

// The way back to the bounds of parameters that were fitted without them.

// The step δ from the optimum `at` to within the bounds of all parameters by which χ² grows least:
// min δᵀ H δ with lowest ≤ θ + δ ≤ highest, H the information there, positive definite. What is
// correlated moves along: to bring one of several numbers back whose sum alone is ill known, all of
// them move. Zero where nothing is beyond a bound. By an active set (Nocedal & Wright, Numerical
// Optimization, 2nd ed. 2006, section 16.5).
Eigen::VectorXd step_to_bounds(const ArrowMatrix& information, const Parameters& at);

}  // namespace photorque::inference
