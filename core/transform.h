// A rotation followed by a translation, named by the frames it joins: world_from_body.
#pragma once

#include "core/vector.h"

namespace photorque {

// Maps points and directions of one right-handed frame into another.
// `rotation` must be of unit norm; `translation_m` is the origin of the source frame, expressed in
// the target frame. Composition reads as the names do: lab_from_led = lab_from_body *
// body_from_led.
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

// Attitude of a platform (lab from body, origin unmoved) tilted by `tilt_rad` towards the compass
// direction `heading_rad`: the body's z axis leans from the vertical towards
// (cos heading, sin heading, 0); no spin about z is added. Tilt 30 deg, heading 0 is a rotation of
// 30 deg about +y.
RigidTransform lab_from_body_at(double tilt_rad, double heading_rad);

// The shortest rotation that takes +z to `direction` (any length but zero), placed at `origin_m`.
// At `direction` = −z it is the half turn about x.
RigidTransform frame_looking_along(const Vec3& direction, const Vec3& origin_m);

}  // namespace photorque
