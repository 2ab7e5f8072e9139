// The camera's noise about one lab axis.
#pragma once

#include <vector>

#include "attitude/noise/angle_likelihood.h"
#include "inference/limits/thresholds.h"

namespace photorque {

// Of one channel: what was found, and how sure that is.
struct FoundNoise {
  ChannelNoise noise;        // to be used: as stated unless something else was found
  bool level_found = false;  // differs from what was stated
  bool colour_found = false;
  double level_sigma = 0.0;   // standard error of ln level
  double time_sigma_s = 0.0;  // of the correlation time
  double gain = 0.0;  // twice the log likelihood of correlated noise over that of the best white
};

struct CameraNoise {
  FoundNoise found;
  AngleNoise axis;     // the likeliest of all
  double value = 0.0;  // its minus two log likelihood
};

// The likeliest noise of the camera in all runs, `gyro` (the gyro's part of it) taken as known.
CameraNoise camera_noise(const std::vector<const KinematicSeries*>& runs,
                         const ChannelNoise& stated, const AngleNoise& gyro,
                         const Thresholds::Noise& limits);

// Whether a level that is off by a factor is one of another noise, with the standard error of the
// factor's logarithm.
bool is_off(double log_factor, double sigma, const Thresholds::Noise& limits);

}  // namespace photorque
