// Prediction of held-out recordings.
#pragma once

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// Propagates a fitted model along other runs. Only initial conditions (initial state, instrument
// biases within their stated uncertainty) are fitted to them.
Fit propagate_model(const Fit& fitted, const std::vector<Observation>& runs,
                    const Thresholds& limits);

// χ² per sample and RMS residual of each channel for two fits to the same held-out runs.
Holdout compare_holdout(const Fit& before, const Fit& after, const std::vector<Observation>& runs);

// Readings and models over time for plots, of run number `run` in two fits to equal runs.
RecordingSeries series_of(const Fit& before, const Fit& after, const Observation& seen, size_t run);

}  // namespace photorque
