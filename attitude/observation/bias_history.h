// The drift of the gyro's bias, by the camera: whatever torque acts, what the gyro reads less what
// the camera sees turning is the gyro's own.
#pragma once

#include <string>
#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// The bias of one recording minus its mean: linear between instants. Body axes.
struct BiasHistory {
  std::string recording;
  std::vector<double> time_s;
  std::vector<Vec3> bias_rad_s;   // at each instant
  std::vector<Vec3> sigma_rad_s;  // standard errors, widened to the noise that is seen

  // The first and last values hold outside.
  Vec3 at(double t_s) const;
};

// Empty where a constant bias does for each recording, and where one has no camera or no gyro or
// turns by more than 0.1 rad from row to row.
// Otherwise a history for each recording (pieces of one name count as one), with a knot about every
// minute. Scale, misalignment, a late camera and the turning of the laboratory, which all
// recordings share, are fitted besides and take what they can.
std::vector<BiasHistory> bias_histories(const std::vector<const Observation*>& pieces);

}  // namespace photorque
