// The noise of the readings: levels that are not as stated, readings that stand out.
#pragma once

#include "attitude/estimation/fit.h"
#include "inference/whiteness.h"

namespace photorque {

// The channels of whitened residuals (readings/channels.h) without gaps, by run.
std::vector<inference::ChannelResiduals> channels_of(const std::vector<Prediction>& residuals);

// The structure that a fit leaves; huge where it cannot be propagated.
double excess_sigma(const Fit& fit, const std::vector<Observation>& runs,
                    const Thresholds::Noise& limits);

// Drops readings that stand out from what their neighbours' residuals lead to. Returns their
// number.
int64_t drop_outliers(const std::vector<Prediction>& residuals, const Thresholds::Noise& limits,
                      std::vector<Observation>& runs);

}  // namespace photorque
