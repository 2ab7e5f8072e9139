// Fewer blocks for the search: means of what is left of a fit, not of the readings.
#pragma once

#include "attitude/estimation/fit.h"

namespace photorque {

// The runs in some `blocks` blocks each. A block stands for its neighbours at the time of the
// middle one: there the fit's prediction and the mean of the neighbours' residuals make a reading.
// Means of the readings themselves would hold the motion's curvature within a block, which looks
// like a late camera or a turned gyro; a mean residual does not, however fast the platform tumbles.
// As good as the runs for changes of the fit that are slow against a block. NumericalError when the
// fit cannot be propagated.
std::vector<Observation> averaged_about(const Fit& fit, const std::vector<Observation>& runs,
                                        size_t blocks);

}  // namespace photorque
