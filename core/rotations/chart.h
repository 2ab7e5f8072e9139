// Coordinates in which what depends on an attitude is smooth.
//
// u is a direction fixed in the lab, seen from the body. Where u points is given on the half of the
// sphere about +z or −z of the body by its stereographic projection from the other pole, p = 2
// tan(θ/2) towards u, |p| ≤ 2 on the half, 0 at the pole. What is left is the turn about that
// direction: the twist ψ of the swing–twist decomposition. In quaternions q = (0, 0, ψ) ⊗ swing(p),
// both maps are rational and have no singularity on their half, and light that is the same all
// round the direction depends on p alone.
#pragma once

#include <array>

#include "core/vector.h"

namespace photorque {

struct RotationPoint {
  int half = 0;  // 0: u within 90 deg of body +z; 1: of body −z, with body x turned by half a turn
  double x = 0.0, y = 0.0;  // p
  double twist_rad = 0.0;   // any turn; equal 2π apart
};

// ∂(x, y, twist)/∂(w, x, y, z) of the quaternion, row by row.
using RotationSlopes = std::array<std::array<double, 4>, 3>;

// Of an attitude whose fixed direction is the outer frame's z (multiply lab_from_body from the left
// to bring another one there). The quaternion may have any length but zero; q and −q are the same.
// `slopes`, if not null, receives the derivatives.
RotationPoint point_of(const Quat& q, RotationSlopes* slopes = nullptr);

// The attitude at a point; the inverse of point_of().
Quat rotation_at(const RotationPoint& point);

// |p| at an angle from the pole of a half, in [0, π).
double radius_at(double angle_rad);

}  // namespace photorque
