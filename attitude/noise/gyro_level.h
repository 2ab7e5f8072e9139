// The level of a gyro's white noise, from the fine end of its spectrum.
#pragma once

#include <optional>
#include <vector>

#include "attitude/noise/kinematics.h"
#include "inference/limits/thresholds.h"

namespace photorque {

// The standard deviation of one reading, and the standard error of its logarithm.
struct NoiseLevel {
  double level = 0.0, log_sigma = 0.0;
};

// Of gyro axis k (body axes) in all runs: from the upper half of the spectrum of differences at
// equal steps, without those across gaps and changes of the commands, the loudest fifth of the
// frequencies left out: lines of what shakes and rings are few. None where too little is left.
std::optional<NoiseLevel> gyro_level(const std::vector<Observation>& seen,
                                     const std::vector<KinematicRun>& runs, int k,
                                     const Thresholds::Noise& limits);

}  // namespace photorque
