// Gravity does not point along the lab's −z, because the camera that defines the lab is not level.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::gravity_tilt {
namespace {

constexpr KeyOf<2> tilt("tilt_rad", "[about x, about y], lab axes: turns lab −z into gravity");

struct GravityTilt final : LawOf<GravityTilt> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const Vec3Of<T> turn(own.element(tilt, 0), own.element(tilt, 1), T(0.0));
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

DisturbanceKind kind() {
  return kind_of_law<GravityTilt, Stage::conditions, tilt>(
      {.name = "gravity_tilt",
       .summary = "the camera that defines the vertical is not level",
       .screening = {
           .parametrisations =
               {{"gravity does not point along the camera's vertical: the camera is not level",
                 {{tilt.name, {0.0, 0.0}, 5e-3}}}},
           .needs = Requirement::gravity}});
}

}  // namespace photorque::kinds::gravity_tilt
