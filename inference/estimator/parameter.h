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
  std::string unit;    // empty if dimensionless or if the name ends in it
  double value = 0.0;  // present value
  // The Gaussian prior N(mean, sigma²); an infinite sigma means no prior.
  double mean = 0.0;
  double sigma = infinity;  // > 0
  // Bounds of the fit; lowest < highest.
  double lowest = -infinity;
  double highest = infinity;

  bool has_prior() const { return sigma < infinity; }
};

// All parameters of a problem, in the order of all steps, gradients and matrices: those of the
// first run, those of the second, …, then the shared ones. Every run has the same number.
struct Parameters {
  std::vector<std::vector<Parameter>>
      of_run;  // nuisance parameters: initial conditions, instrument bias
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

// The step δ from the optimum `at` to within all bounds that raises χ² least: min δᵀ H δ with
// lowest ≤ θ + δ ≤ highest, where H is the positive definite information there. Correlated
// parameters move too: if only the sum of several is ill determined, bringing one back to its bound
// moves all. Zero if no bound is violated. Active-set method (Nocedal & Wright, Numerical
// Optimization, 2nd ed. 2006, section 16.5).
Eigen::VectorXd step_to_bounds(const ArrowMatrix& information, const Parameters& at);

}  // namespace photorque::inference
