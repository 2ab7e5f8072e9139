// A swirl of the air that leaves the socket drives the ball: a constant torque about lab z. The
// supply is assumed to be steady and the gap independent of the attitude. Catalogues state no
// value; it is measured or fitted.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::turbine_torque {
namespace {

constexpr ScalarKey torque_up("torque_N_m", {},
                              "torque about lab z; positive: counterclockwise seen from above");

struct TurbineTorque final : TorqueLaw<TurbineTorque> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return own[torque_up] * now.lab_from_body.row(2).transpose();
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<TurbineTorque, Stage::torque, torque_up>(
      {.name = "turbine_torque",
       .summary = "swirling exhaust of the bearing turns the platform about the vertical",
       .screening = {.parametrisations = {{"the bearing's exhaust drives the platform about the "
                                           "vertical with a constant torque",
                                           {EffectKey::number(torque_up.name, 5e-6)}}},
                     .needs = Requirement::air_bearing,
                     .confusable_kinds = {{"room_draft"}}}});
}

}  // namespace photorque::kinds::turbine_torque
