#include "core/transform.h"

#include <cmath>

namespace photorque {

RigidTransform lab_from_body_at(double tilt_rad, double heading_rad) {
  const Vec3 tilt_axis(-std::sin(heading_rad), std::cos(heading_rad), 0.0);
  return {Quat(Eigen::AngleAxisd(tilt_rad, tilt_axis)), Vec3::Zero()};
}

Quat rotation_between(const Vec3& from, const Vec3& to) {
  return Quat::FromTwoVectors(from, to);
}

RigidTransform frame_looking_along(const Vec3& direction, const Vec3& origin_m) {
  const Vec3 z = direction.normalized();
  if (z.z() < -1.0 + 1e-12) return {Quat(0.0, 1.0, 0.0, 0.0), origin_m};
  return {rotation_between(Vec3::UnitZ(), z).normalized(), origin_m};
}

}  // namespace photorque
