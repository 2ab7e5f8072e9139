// Vectors, rotations and rigid transforms: fixed-size linear algebra.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace photorque {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;  // Hamilton, (w, x, y, z)
using Affine = Eigen::Affine3d;   // any linear part, may be non-uniform or mirrored

// skew(a) b = a × b.
inline Mat3 skew(const Vec3& a) {
  Mat3 m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

// A rotation followed by a translation, named by the frames it joins: world_from_body.
// Maps points and directions of one right-handed frame into another.
// `rotation` must be of unit norm; `translation_m` is the origin of the source frame, expressed in
// the target frame. Composition: lab_from_led = lab_from_body * body_from_led.
struct RigidTransform {
  Quat rotation = Quat::Identity();
  Vec3 translation_m = Vec3::Zero();

  Vec3 point(const Vec3& p_m) const { return rotation * p_m + translation_m; }
  Vec3 direction(const Vec3& d) const { return rotation * d; }

  RigidTransform inverse() const {
    const Quat inverse_rotation = rotation.conjugate();
    return {inverse_rotation, -(inverse_rotation * translation_m)};
  }
};

inline RigidTransform operator*(const RigidTransform& a_from_b, const RigidTransform& b_from_c) {
  return {(a_from_b.rotation * b_from_c.rotation).normalized(),
          a_from_b.rotation * b_from_c.translation_m + a_from_b.translation_m};
}

// Attitude of a platform (lab from body, origin unmoved) that is tilted by `tilt_rad` towards the
// compass direction `heading_rad`: the body's z axis is tilted from the vertical towards (cos
// heading, sin heading, 0). No rotation about z is added. Tilt 30 deg, heading 0 is a rotation of
// 30 deg about +y.
RigidTransform lab_from_body_at(double tilt_rad, double heading_rad);

// The shortest rotation that takes +z to `direction` (any length but zero), placed at `origin_m`.
// At `direction` = −z it is the half turn about x.
RigidTransform frame_looking_along(const Vec3& direction, const Vec3& origin_m);

// The shortest rotation that takes the direction of `from` to that of `to` (any lengths but zero).
Quat rotation_between(const Vec3& from, const Vec3& to);

// Rotations as rotation vectors, for filters and least squares over attitudes.

// The rotation by a rotation vector [rad].
inline Quat turn_by(const Vec3& rotation_rad) {
  const double angle_rad = rotation_rad.norm();
  if (!(angle_rad > 0.0)) return Quat::Identity();
  return Quat(Eigen::AngleAxisd(angle_rad, rotation_rad / angle_rad));
}

// The rotation vector of a rotation, of length at most π [rad]; exact also for small rotations.
inline Vec3 turn_vector(const Quat& rotation) {
  const double half_sine = rotation.vec().norm();
  if (half_sine == 0.0) return Vec3::Zero();
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
