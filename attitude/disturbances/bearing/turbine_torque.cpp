// Air that leaves the socket in a swirl turns the ball: a constant torque about lab z.
//
// torque_N_m: positive counterclockwise from above. Steady supply and a gap that does not depend on
// the attitude are assumed; catalogues give no figure, so it is measured or fitted.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct TurbineTorque final : TorqueLaw<TurbineTorque> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return own.parameter(0) * now.lab_from_body.row(2).transpose();
  }
};

}  // namespace

DisturbanceKind turbine_torque_kind() {
  return {"turbine_torque", "swirling exhaust of the bearing turns the platform about the vertical",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<TurbineTorque>({scalar_parameter(settings, "torque_N_m")});
          }};
}

}  // namespace photorque
