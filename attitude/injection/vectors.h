// Arithmetic of three numbers for the injected motion.
#pragma once

#include <array>
#include <cmath>

namespace photorque::injected {

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;      // rows
using Quaternion = std::array<double, 4>;  // w, x, y, z

inline Triple plus(const Triple& a, const Triple& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Triple times(double s, const Triple& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
inline Triple minus(const Triple& a, const Triple& b) {
  return plus(a, times(-1.0, b));
}
inline Triple cross(const Triple& a, const Triple& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double dot(const Triple& a, const Triple& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Triple& a) {
  return std::sqrt(dot(a, a));
}
inline Triple by_component(const Triple& a, const Triple& b) {
  return {a[0] * b[0], a[1] * b[1], a[2] * b[2]};
}
inline Triple times(const Matrix& m, const Triple& a) {
  return {dot(m[0], a), dot(m[1], a), dot(m[2], a)};
}
inline Matrix inverse(const Matrix& m) {
  const Triple a = cross(m[1], m[2]), b = cross(m[2], m[0]), c = cross(m[0], m[1]);
  const double d = dot(m[0], a);
  Matrix inverse;
  for (size_t i = 0; i < 3; ++i) inverse[i] = {a[i] / d, b[i] / d, c[i] / d};
  return inverse;
}

inline Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}
inline Quaternion conjugate(const Quaternion& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}
inline Quaternion normalised(const Quaternion& q) {
  const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {q[0] / n, q[1] / n, q[2] / n, q[3] / n};
}
// A lab vector in body axes, for a unit quaternion lab from body.
inline Triple to_body(const Quaternion& q, const Triple& v) {
  const Quaternion r = product(conjugate(q), product({0.0, v[0], v[1], v[2]}, q));
  return {r[1], r[2], r[3]};
}
// The rotation by the vector `turn`, and back; angles below π.
inline Quaternion quaternion_of(const Triple& turn) {
  const double angle = length(turn);
  const double s = angle < 1e-12 ? 0.5 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), s * turn[0], s * turn[1], s * turn[2]};
}
inline Triple turn_of(const Quaternion& q) {
  const double side = q[0] < 0.0 ? -1.0 : 1.0;
  const Triple v = {side * q[1], side * q[2], side * q[3]};
  const double sine = length(v);
  return times(sine < 1e-12 ? 2.0 : 2.0 * std::atan2(sine, side * q[0]) / sine, v);
}

}  // namespace photorque::injected
