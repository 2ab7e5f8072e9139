// The noise of the readings, determined from the readings under any torque.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "attitude/observation/camera_noise.h"

namespace photorque {

// The growth of the camera's delay against the gyro's clock [s/s], and its standard error.
struct ClockDrift {
  double rate = 0.0, sigma = 0.0;
};

struct NoiseFindings {
  // The model that the readings were compared with is far from them: the noise stays as stated
  // until a better one is at hand.
  bool is_open = false;
  std::array<FoundNoise, 6> channel;  // camera about lab x, y, z; gyro x, y, z
  std::optional<ClockDrift> drift;    // where there is a gyro
};

// `about`: predictions of a fit for the runs with their residuals; empty: there is no such fit. The
// noise of the first run is taken as stated for all. Deterministic.
NoiseFindings find_noise(const std::vector<Observation>& runs, const std::vector<Prediction>& about,
                         const Thresholds::Noise& limits);

}  // namespace photorque
