// The nominal model of the platform, ready to be fitted.
#pragma once

#include <vector>

#include "attitude/estimation/fit.h"
#include "attitude/propagation/run.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

// Every parameter with a sigma is free about its nominal value; gyro biases are free for each run.
// The runs start from what was seen at their beginning.
Hypothesis nominal_hypothesis(const NominalModel& nominal, const std::vector<Observation>& runs);

// Appends a disturbance: its own states begin at rest in every run. Returns its index.
size_t add_disturbance(Hypothesis& hypothesis, const Disturbance& disturbance);

// The nominal model fitted to the runs, over windows that grow.
Fit fit_nominal(const NominalModel& nominal, const std::vector<Observation>& runs,
                const Thresholds& limits = {});

}  // namespace photorque
