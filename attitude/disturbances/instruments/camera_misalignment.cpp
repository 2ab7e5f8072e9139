// A camera target that is mounted at a small angle to the body axes.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::camera_misalignment {
namespace {

constexpr VectorKey turn("misalignment_rad",
                         "rotation vector from the true to the measured body axes");

// The measured attitude is q ⊗ exp(m/2) with the rotation vector m, in body axes, from the true to
// the measured body axes.
struct CameraMisalignment final : LawOf<CameraMisalignment> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.camera_error_rad += own[turn];
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<CameraMisalignment, Stage::measurement, turn>(
      {.name = "camera_misalignment",
       .summary = "the camera's target is mounted at a small angle to the body axes",
       .screening = {.parametrisations =
                         {{"the camera's target is mounted at a small angle to the body axes",
                           {EffectKey::vector(turn.name, 5e-3)}}}},
       .budget = {.reason_against = "an error of an instrument: no torque"},
       .instrument = "camera"});
}

}  // namespace photorque::kinds::camera_misalignment
