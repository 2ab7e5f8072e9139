// The drift of the gyro's bias, determined from the camera. It is the gyro reading minus the
// rotation that the camera measures, independent of the torques.
#pragma once

#include <string>
#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// The bias of one recording minus its mean, linear between the given times. Body axes.
struct BiasHistory {
  std::string recording;
  std::vector<double> time_s;
  std::vector<Vec3> bias_rad_s;   // at each time
  std::vector<Vec3> sigma_rad_s;  // standard errors, scaled to the observed noise

  // The bias at a time. Before the first and after the last time it is constant.
  Vec3 at(double t_s) const;
};

// The histories of the biases, one for each recording (segments with one name count as one), with a
// knot about every minute. Errors that all recordings have in common are fitted too: scale,
// misalignment, camera delay and rotation of the laboratory. Empty if a constant bias is sufficient
// for each recording. Empty too if a recording has no camera or no gyro, or if it rotates by more
// than 0.1 rad from row to row.
std::vector<BiasHistory> bias_histories(const std::vector<const Observation*>& pieces);

}  // namespace photorque
