// A camera's target mounted at a small angle to the body axes.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

// The attitude seen is q ⊗ exp(m/2) for the rotation vector m, in body axes, from the true to the
// seen body axes.
struct CameraMisalignment final : LawOf<CameraMisalignment> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.camera_error_rad += own.vector(0);
  }
};

}  // namespace

DisturbanceKind camera_misalignment_kind() {
  return {"camera_misalignment", "the camera's target is mounted at a small angle to the body axes",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<CameraMisalignment>(
                {vector_parameter(settings, "misalignment_rad")}, Stage::measurement);
          }};
}

}  // namespace photorque
