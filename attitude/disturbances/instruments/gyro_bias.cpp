// A gyro that reads a constant rate at rest.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::gyro_bias {
namespace {

constexpr VectorKey bias("bias_rad_s", "reading at rest");

struct GyroBias final : LawOf<GyroBias> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.gyro_error_rad_s += own[bias];
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  return make_disturbance<GyroBias>({vector_parameter(settings, bias)}, Stage::measurement);
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "gyro_bias",
      .summary = "the gyro reads a constant rate at rest",
      .read = read,
      .screening = {.parametrisations =
                        {{"the gyro reads a constant rate at rest, beyond the uncertainty stated",
                          {EffectKey::vector(bias.name, 5e-3)}}},
                    .per_recording = true},
      .budget = {.reason_against = "an error of an instrument: no torque"},
      .instrument = "gyro",
      .keys = {bias}};
}

}  // namespace photorque::kinds::gyro_bias
