// Actuators give another torque than commanded: T = gain_error × command.
//
// gain_error: one number, or one for each body axis; 0.1 is 10 % too much.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct CommonGain final : TorqueLaw<CommonGain> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return own.parameter(0) * now.command_body_N_m;
  }
};

struct AxisGain final : TorqueLaw<AxisGain> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return own.vector(0).cwiseProduct(now.command_body_N_m);
  }
};

}  // namespace

DisturbanceKind actuator_gain_kind() {
  return {"actuator_gain", "actuators give more or less torque than commanded",
          [](const Settings& settings, const DisturbanceContext&) {
            if (count_as_written(settings, "gain_error") > 0) {
              return make_disturbance<AxisGain>({vector_parameter(settings, "gain_error")});
            }
            return make_disturbance<CommonGain>({scalar_parameter(settings, "gain_error")});
          }};
}

}  // namespace photorque
