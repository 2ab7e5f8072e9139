#include "core/rotations/chart.h"

#include <cmath>

namespace photorque {

RotationPoint point_of(const Quat& q, RotationSlopes* slopes) {
  // The other half is the first one of a body turned by half a turn about x: q ⊗ (0, 1, 0, 0).
  const bool other = q.x() * q.x() + q.y() * q.y() > q.w() * q.w() + q.z() * q.z();
  const double w = other ? -q.x() : q.w(), x = other ? q.w() : q.x();
  const double y = other ? q.z() : q.y(), z = other ? -q.y() : q.z();
  const double n = w * w + z * z;
  RotationPoint point;
  point.half = other ? 1 : 0;
  point.x = 2.0 * (x * z - w * y) / n;
  point.y = 2.0 * (y * z + w * x) / n;
  point.twist_rad = 2.0 * std::atan2(z, w);
  if (slopes == nullptr) return point;
  const double two = 2.0 / n;
  const std::array<std::array<double, 4>, 3> own = {
      {{-two * (y + w * point.x), two * z, -two * w, two * (x - z * point.x)},
       {two * (x - w * point.y), two * w, two * z, two * (y - z * point.y)},
       {-two * z, 0.0, 0.0, two * w}}};
  if (!other) {
    *slopes = own;
    return point;
  }
  // (w, x, y, z) of the turned body are (−x, w, z, −y) of this one.
  for (size_t r = 0; r < 3; ++r) (*slopes)[r] = {own[r][1], -own[r][0], -own[r][3], own[r][2]};
  return point;
}

Quat rotation_at(const RotationPoint& point) {
  const Quat swing = Quat(1.0, 0.5 * point.y, -0.5 * point.x, 0.0).normalized();
  const Quat twist(std::cos(0.5 * point.twist_rad), 0.0, 0.0, std::sin(0.5 * point.twist_rad));
  const Quat half = twist * swing;
  // Back by half a turn about x the other way.
  return point.half == 0 ? half : half * Quat(0.0, -1.0, 0.0, 0.0);
}

double radius_at(double angle_rad) {
  return 2.0 * std::tan(0.5 * angle_rad);
}

}  // namespace photorque
