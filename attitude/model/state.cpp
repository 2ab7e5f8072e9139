#include "attitude/model/state.h"

#include <cmath>

namespace photorque {

double tilt_rad(const PlatformState& state) {
  // sin(tilt/2)² = x² + y²: exact near zero, where the cosine of the tilt is blind.
  const Quat& q = state.lab_from_body;
  return 2.0 * std::atan2(std::hypot(q.x(), q.y()), std::hypot(q.w(), q.z()));
}

double heading_rad(const PlatformState& state) {
  const Vec3 body_x_lab = state.lab_from_body * Vec3::UnitX();
  return std::atan2(body_x_lab.y(), body_x_lab.x());
}

}  // namespace photorque
