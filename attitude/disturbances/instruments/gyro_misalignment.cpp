// A gyro mounted at a small angle to the body axes.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::gyro_misalignment {
namespace {

constexpr VectorKey turn("misalignment_rad", "rotation vector of the mounting");

// reading − ω = m × ω, where m is the mounting rotation vector of the body axes relative to the
// gyro's. First order, with an error of |m|²/2.
struct GyroMisalignment final : LawOf<GyroMisalignment> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.gyro_error_rad_s += own[turn].cross(now.inertial_rate_body_rad_s);
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<GyroMisalignment, Stage::measurement, turn>(
      {.name = "gyro_misalignment",
       .summary = "the gyro is mounted at a small angle to the body axes",
       .screening = {.parametrisations = {{"the gyro is mounted at a small angle to the body axes",
                                           {EffectKey::vector(turn.name, 0.01)}}}},
       .budget = {.reason_against = "an error of an instrument: no torque"},
       .instrument = "gyro"});
}

}  // namespace photorque::kinds::gyro_misalignment
