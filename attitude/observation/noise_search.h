// Determines the noise of the readings from the readings, independent of the torques.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "attitude/observation/camera_noise.h"

namespace photorque {

// Growth of the camera's delay relative to the gyro's clock [s/s], and its standard error.
struct ClockDrift {
  double rate = 0.0, sigma = 0.0;
};

struct NoiseFindings {
  // The readings are far from the model with which they were compared. The noise stays as stated
  // until there is a better model.
  bool is_open = false;
  std::array<FoundNoise, 6> channel;  // camera about lab x, y, z; gyro x, y, z
  std::optional<ClockDrift> drift;    // only with a gyro
};

// Estimates the noise of the runs. `about`: predictions of a fit for the runs, with their
// residuals; empty if there is no fit. The stated noise of the first run applies to all.
// Deterministic.
NoiseFindings find_noise(const std::vector<Observation>& runs, const std::vector<Prediction>& about,
                         const Thresholds::Noise& limits);

}  // namespace photorque
