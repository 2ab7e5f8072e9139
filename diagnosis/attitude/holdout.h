// Prediction of recordings that were never fitted.
#pragma once

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// The model of a fit propagated on other runs: only how these runs began (initial state, instrument
// biases within their stated uncertainty) is taken from them.
Fit propagate_model(const Fit& fitted, const std::vector<Observation>& runs,
                    const Thresholds& limits);

Holdout compare_holdout(const Fit& before, const Fit& after, const std::vector<Observation>& runs);

// Readings and models over time for plots: the run `run` of two fits of the same runs.
RecordingSeries series_of(const Fit& before, const Fit& after, const Observation& seen, size_t run);

}  // namespace photorque
