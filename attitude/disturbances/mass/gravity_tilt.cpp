// Gravity does not point along the lab's −z, because the camera that defines the lab is not level.
//
// tilt_rad[2]: the rotation vector, about lab x and y, that takes the lab's −z to gravity.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct GravityTilt final : LawOf<GravityTilt> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const Vec3Of<T> turn(own.parameter(0), own.parameter(1), T(0.0));
    const T angle = length(turn);
    const Vec3Of<T> axis = turn / angle;
    const T cosine = cos(angle), sine = sin(angle);
    // Rodrigues' formula.
    for (Vec3Of<T>* v : {&now.gravity_lab_m_s2, &now.up_lab}) {
      *v = Vec3Of<T>(cosine * *v + sine * axis.cross(*v) + (T(1.0) - cosine) * axis.dot(*v) * axis);
    }
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
