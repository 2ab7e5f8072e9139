// A hypothesis fitted to recordings by the program's one estimator (inference/estimator/fit.h).
#pragma once

#include <vector>

#include "attitude/estimation/hypothesis.h"
#include "attitude/observation/prediction.h"
#include "inference/estimator/fit.h"

namespace photorque {

struct Fit : inference::Fit {
  Hypothesis best;
};

struct FitSettings : inference::Options {
  double tolerance = 1e-7;  // of the propagation
};

// Never throws for a model that cannot be propagated at the start: then chi2 is infinite.
Fit fit(const Hypothesis& start, const std::vector<Observation>& runs,
        const FitSettings& settings = {});

// Where a fit ended, brought to within the bounds that `free` has by the step that costs least χ²;
// `free` are the free parameters of the fit, in its order, with bounds that it may have left. What
// is correlated with them moves along.
Hypothesis within_bounds(const Fit& fit, std::vector<Free> free,
                         const std::vector<Observation>& runs);

// The sums of all runs at the present values, without fitting: parameters as in Fit::hessian, and
// then `extra`, parameters of the model that are not free. With the priors of what is free.
inference::SumsOfRuns sums_at(const Hypothesis& at, const std::vector<Observation>& runs,
                              const std::vector<Free>& extra, double tolerance = 1e-7);

// All whitened residuals of a fit, by run. NumericalError where it cannot be propagated.
std::vector<Prediction> residuals_of(const Fit& fit, const std::vector<Observation>& runs);

}  // namespace photorque
