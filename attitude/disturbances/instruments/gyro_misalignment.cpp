// A gyro mounted at a small angle to the body axes.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

// reading − ω = m × ω for a mounting rotation vector m of the body axes against the gyro's: first
// order, good to |m|²/2.
struct GyroMisalignment final : LawOf<GyroMisalignment> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.gyro_error_rad_s += own.vector(0).cross(now.inertial_rate_body_rad_s);
  }
};

}  // namespace

DisturbanceKind gyro_misalignment_kind() {
  return {"gyro_misalignment", "the gyro is mounted at a small angle to the body axes",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<GyroMisalignment>(
                {vector_parameter(settings, "misalignment_rad")}, Stage::measurement);
          }};
}

}  // namespace photorque
