// A hypothesis fitted to recordings by the program's one estimator (inference/estimator/fit.h).
#pragma once

#include <vector>

#include "attitude/estimation/hypothesis.h"
#include "attitude/observation/prediction.h"
#include "inference/estimator/fit.h"
#include "inference/estimator/thresholds.h"
#include "inference/whiteness.h"

namespace photorque {

struct NominalModel;  // attitude/propagation/run.h

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

// The noise of the readings: levels that are not as stated, readings that stand out.

// The channels of whitened residuals (recordings/columns.h) without gaps, by run.
std::vector<inference::ChannelResiduals> channels_of(const std::vector<Prediction>& residuals);

// The structure that a fit leaves; huge where it cannot be propagated.
double excess_sigma(const Fit& fit, const std::vector<Observation>& runs,
                    const Thresholds::Noise& limits);

// Drops outliers, compared with the prediction from their neighbours' residuals. Returns their
// number.
int64_t drop_outliers(const std::vector<Prediction>& residuals, const Thresholds::Noise& limits,
                      std::vector<Observation>& runs);

// Fewer blocks for the search: means of a fit's residuals, not of the readings.

// The runs in some `blocks` blocks each. A block stands for its neighbours at the time of the
// middle one: there the fit's prediction and the mean of the neighbours' residuals make a reading.
// Means of the readings themselves would hold the motion's curvature within a block, which looks
// like a late camera or a turned gyro; a mean residual does not, however fast the platform tumbles.
// As good as the runs for changes of the fit that are slow against a block. NumericalError when the
// fit cannot be propagated.
std::vector<Observation> averaged_about(const Fit& fit, const std::vector<Observation>& runs,
                                        size_t blocks);

// The nominal model of the platform, ready to be fitted.

// Every parameter with a sigma is free about its nominal value; gyro biases are free for each run.
// The runs start from their first readings.
Hypothesis nominal_hypothesis(const NominalModel& nominal, const std::vector<Observation>& runs);

// Appends a disturbance: its own states begin at rest in every run. Returns its index.
size_t add_disturbance(Hypothesis& hypothesis, const Disturbance& disturbance);

// The nominal model fitted to the runs, over windows that grow.
Fit fit_nominal(const NominalModel& nominal, const std::vector<Observation>& runs,
                const Thresholds& limits = {});

}  // namespace photorque
