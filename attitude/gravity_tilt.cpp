// Gravity does not point along the lab's −z, because the camera that defines the lab is not level.
//
// tilt_rad[2]: the rotation vector, about lab x and y, that takes the lab's −z to gravity.
#include "attitude/disturbance_kind.h"

namespace photorque {
namespace {

struct GravityTilt final : LawOf<GravityTilt> {
  template <class T>
  void apply(const Own<T>& own, Moment<T>& now) const {
    const Vec3Of<T> turn(own.parameter(0), own.parameter(1), T(0.0));
    const T angle = length(turn);
    const Vec3Of<T> axis = turn / angle;
    now.gravity_lab_m_s2 = rotated(now.gravity_lab_m_s2, axis, angle);
    now.up_lab = rotated(now.up_lab, axis, angle);
  }

  // Rodrigues' formula.
  template <class T>
  static Vec3Of<T> rotated(const Vec3Of<T>& v, const Vec3Of<T>& axis, const T& angle) {
    return cos(angle) * v + sin(angle) * axis.cross(v) + (T(1.0) - cos(angle)) * axis.dot(v) * axis;
  }
};

}  // namespace

DisturbanceKind gravity_tilt_kind() {
  return {"gravity_tilt", "the camera that defines the vertical is not level",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<GravityTilt>({array_parameter(settings, "tilt_rad", 2)},
                                                 Stage::conditions);
          }};
}

}  // namespace photorque
