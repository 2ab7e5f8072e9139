// Actuators give more or less torque or force than commanded: T = gain_error × command is added.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::actuator_gain {
namespace {

constexpr ScalarKey common_gain(
    "gain_error", {},
    "e: actuators give (1 + e) times the command; one number, or one for "
    "each body axis (planar: x and y of the forces, z of the torque)");
constexpr VectorKey axis_gain{common_gain.name};

struct CommonGain final : LawOf<CommonGain> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.torque_body_N_m += own[common_gain] * now.command_body_N_m;
    now.force_lab_N += own[common_gain] * now.command_lab_N;
  }
};

struct AxisGain final : LawOf<AxisGain> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const Vec3Of<T> gain = own[axis_gain];
    now.torque_body_N_m += gain.cwiseProduct(now.command_body_N_m);
    now.force_lab_N += now.lab_from_body * gain.cwiseProduct(now.to_body(now.command_lab_N));
  }
};

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "actuator_gain",
      .summary = "actuators give more or less torque or force than commanded",
      .read = read_one_or_three<CommonGain, AxisGain, common_gain>,
      .screening = {.parametrisations = {{"the actuators give more or less torque than commanded",
                                          {EffectKey::number(common_gain.name, 0.2)}},
                                         {"the actuators give more or less torque than commanded, "
                                          "with a separate factor for each axis",
                                          {EffectKey::vector(common_gain.name, 0.2)}}},
                    .needs = Requirement::command},
      .keys = {Key(common_gain).one_or_several(3)}};
}

}  // namespace photorque::kinds::actuator_gain
