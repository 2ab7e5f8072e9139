// Starts for an appendage that swings: its frequency and axis.
#pragma once

#include "diagnosis/attitude/scans/scan.h"

namespace photorque {

// The most promising flexible modes to add to `fit`, at most three. `start` is the disturbance with
// its expected strength, `slow_runs` averages of the runs, as good for what is slow.
std::vector<Start> flexible_mode_starts(const Disturbance& start, const Fit& fit,
                                        const std::vector<Observation>& runs,
                                        const std::vector<Observation>& slow_runs,
                                        const Thresholds::Scoring& limits);

}  // namespace photorque
