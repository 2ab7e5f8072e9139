// Fits a hypothesis to recordings with the common estimator (inference/estimator/fit.h).
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

// Fits the free parameters. chi2 is infinite if the model cannot be propagated at the start.
Fit fit(const Hypothesis& start, const std::vector<Observation>& runs,
        const FitSettings& settings = {});

// The result of a fit, moved into the bounds of `free` by the step that increases χ² least. `free`
// are the free parameters of the fit, in its order, with bounds that it may violate. Correlated
// parameters move too.
Hypothesis within_bounds(const Fit& fit, std::vector<Free> free,
                         const std::vector<Observation>& runs);

// Normal sums of all runs at the present values, without a fit. The parameters are those of
// Fit::hessian, followed by `extra`: parameters of the model that are not free. Priors of the free
// parameters are included.
inference::SumsOfRuns sums_at(const Hypothesis& at, const std::vector<Observation>& runs,
                              const std::vector<Free>& extra, double tolerance = 1e-7);

// All whitened residuals of a fit, of one run or one entry per run. NumericalError if it cannot be
// propagated.
Prediction residuals_of(const Fit& fit, size_t run, const Observation& seen);
std::vector<Prediction> residuals_of(const Fit& fit, const std::vector<Observation>& runs);

// Significance of the residual structure of a fit, in standard deviations: of means of neighbouring
// residuals, and of the χ² per reading above `limits.held_out.max_noise`.
// `limits.noise.excess_unknown` if the fit cannot be propagated.
double excess_sigma(const Fit& fit, const std::vector<Observation>& runs, const Thresholds& limits);

// Drops outliers, which are readings far from the prediction by the residuals of their neighbours.
// Returns their number.
int64_t drop_outliers(const std::vector<Prediction>& residuals, const Thresholds::Noise& limits,
                      std::vector<Observation>& runs);

// Reduces each run to about `blocks` blocks for the search. A block replaces neighbouring rows: at
// the time of the middle row its reading is the fit's prediction plus the mean residual of the
// rows. A mean of the readings would contain the curvature of the motion within a block, which
// looks like a late camera or a rotated gyro. The mean residual does not, even for a fast tumbling
// platform. The blocks are equivalent to the runs for changes of the fit that are slow compared
// with a block. NumericalError if the fit cannot be propagated.
std::vector<Observation> averaged_about(const Fit& fit, const std::vector<Observation>& runs,
                                        size_t blocks);

// The nominal model with its free parameters. Every parameter with a sigma is free about its
// nominal value, and gyro biases are free for each run. The runs start from their first readings.
Hypothesis nominal_hypothesis(const NominalModel& nominal, const std::vector<Observation>& runs);

// Appends a disturbance, whose extra states start at rest in every run. Returns its index.
size_t add_disturbance(Hypothesis& hypothesis, const Disturbance& disturbance);

// Chooses the starts of runs that have scalar readings (recordings/columns.h) but no attitude
// readings. A tilt does not determine its direction, nor the magnitude of a rate its axis, and fits
// from a wrong start end in other local minima. Many tilt directions and rotation axes are tried.
// The one whose fit of the first blocks has the smallest χ² becomes the start. Other runs keep
// their start.
void choose_starts(Hypothesis& hypothesis, const std::vector<Observation>& runs);

// Fits the nominal model to the runs, over growing windows.
Fit fit_nominal(const NominalModel& nominal, const std::vector<Observation>& runs,
                const Thresholds& limits = {});

}  // namespace photorque
