// A kind of disturbance that the program does not have: a torque about body x that grows with the
// charge drawn. This file alone describes it.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::added_torque {
namespace {

constexpr ScalarKey growth("torque_N_m", {}, "per ampere-hour drawn");

struct AddedTorque final : TorqueLaw<AddedTorque> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const T charge_Ah = now.charge_drawn_C / 3600.0;
    return {own[growth] * charge_Ah, T(0.0), T(0.0)};
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<AddedTorque, Stage::torque, growth>(
      {.name = "added_torque",
       .summary = "a torque about body x in proportion to the charge drawn",
       .screening = {.parametrisations = {{"something grows with the charge drawn",
                                           {EffectKey::number(growth.name, 1e-4)}}},
                     .needs = Requirement::charge}});
}

}  // namespace photorque::kinds::added_torque
