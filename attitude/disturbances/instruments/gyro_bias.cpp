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

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<GyroBias, Stage::measurement, bias>(
      {.name = "gyro_bias",
       .summary = "the gyro reads a constant rate at rest",
       .screening = {.parametrisations =
                         {{"the gyro reads a constant rate at rest, beyond the uncertainty stated",
                           {EffectKey::vector(bias.name, 5e-3)}}},
                     .per_recording = true},
       .budget = {.reason_against = "an error of an instrument: no torque"},
       .instrument = "gyro"});
}

}  // namespace photorque::kinds::gyro_bias
