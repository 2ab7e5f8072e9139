// Noise with more large errors than a normal distribution.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "attitude/observation/prediction.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

// Student's t distribution of a channel's errors.
struct HeavyTail {
  double degrees = 0.0;        // of freedom
  double degrees_sigma = 0.0;  // standard error
  double scale = 0.0;          // rad or rad/s, of one reading
};

// Tails of channels 0 to 5 (camera about lab x, y, z, gyro about body x, y, z).
using HeavyTails = std::array<std::optional<HeavyTail>, 6>;

// Finds the channels with heavy tails. The error of a reading is its distance from a smooth curve
// through the residuals of its neighbours, independent of slow torques. `residuals`: predictions
// near the runs, with `off`. Channels with correlated deviations are omitted, because these are due
// to motion or to another kind of noise. Deterministic.
HeavyTails heavy_tails(const std::vector<Prediction>& residuals,
                       const std::vector<Observation>& runs, const Thresholds::Noise& limits);

// Replaces the readings of those channels by pseudo-values: readings far from their neighbours are
// moved towards them. The least-squares mean of pseudo-values has the error of the
// maximum-likelihood location under Student's t (Huber 1981, section 7.8). The remaining noise is
// nearly normal. Its standard deviation is √((ν + 3)/(ν + 1)) times the scale, the Cramér-Rao bound
// of a location under Student's t (Lange, Little, Taylor 1989, J. Am. Stat. Assoc. 84, 881).
void robustify(const HeavyTails& tails, const std::vector<Prediction>& residuals,
               std::vector<Observation>& runs);

// Standard deviation of the readings of a channel about a smooth curve through their neighbours,
// for one row [rad or rad/s]. 0: too few readings.
double deviation_level(const std::vector<Prediction>& residuals,
                       const std::vector<Observation>& runs, int channel);

// Drops readings in bursts: several successive readings far from a smooth curve, between readings
// near it. Returns their number.
int64_t drop_bursts(const std::vector<Prediction>& residuals, const Thresholds::Noise& limits,
                    std::vector<Observation>& runs);

}  // namespace photorque
