// Rotations as rotation vectors: what filters and least squares over attitudes need.
#pragma once

#include <cmath>

#include "core/vector.h"

namespace photorque {

// skew(a) b = a × b.
inline Mat3 skew(const Vec3& a) {
  Mat3 m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

// The rotation by a rotation vector [rad].
inline Quat turn_by(const Vec3& rotation_rad) {
  const double angle_rad = rotation_rad.norm();
  if (!(angle_rad > 0.0)) return Quat::Identity();
  return Quat(Eigen::AngleAxisd(angle_rad, rotation_rad / angle_rad));
}

// The rotation vector of a rotation, at most π long [rad]; exact for small ones too.
inline Vec3 turn_vector(const Quat& rotation) {
  const double half_sine = rotation.vec().norm();
  if (!(half_sine > 0.0)) return Vec3::Zero();
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  return sign * 2.0 * std::atan2(half_sine, std::abs(rotation.w())) / half_sine * rotation.vec();
}

// turn_by(θ + δ) = turn_by(J δ) turn_by(θ) to first order in δ, for the left Jacobian J(θ).
// Source: T. Barfoot, State Estimation for Robotics (2017), eq. 7.77.
inline Mat3 turn_jacobian(const Vec3& rotation_rad) {
  const double a = rotation_rad.norm();
  const Mat3 cross = skew(rotation_rad);
  // Below this the next term of the series is less than a rounding error.
  constexpr double small_rad = 1e-5;
  if (a < small_rad) return Mat3::Identity() + 0.5 * cross + cross * cross / 6.0;
  return Mat3::Identity() + (1.0 - std::cos(a)) / (a * a) * cross +
         (a - std::sin(a)) / (a * a * a) * cross * cross;
}

}  // namespace photorque
