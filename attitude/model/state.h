// The state of a platform: attitude, rate, charge, and the extra states of its disturbances.
#pragma once

#include <vector>

#include "core/transform.h"

namespace photorque {

struct PlatformState {
  double time_s = 0.0;
  Quat lab_from_body = Quat::Identity();  // unit norm, Hamilton, rotates body into lab
  Vec3 rate_body_rad_s = Vec3::Zero();    // of the body with respect to the lab, body axes
  double charge_drawn_C = 0.0;            // from the battery since it was full
  // The extra states of all disturbances, one after the other in their order (ExtraState).
  std::vector<double> extra;
};

// Angle between body z and lab z, in [0, π].
double tilt_rad(const PlatformState& state);
// Direction in the lab's horizontal plane in which body x points, from east towards north, in
// (−π, π].
double heading_rad(const PlatformState& state);

}  // namespace photorque
