// A gyro whose axes read too much or too little, in proportion.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

// reading − ω = s_i ω_i on each axis.
struct GyroScale final : LawOf<GyroScale> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    for (int i = 0; i < 3; ++i) {
      now.gyro_error_rad_s[i] += own.parameter(i) * now.inertial_rate_body_rad_s[i];
    }
  }
};

}  // namespace

DisturbanceKind gyro_scale_kind() {
  return {"gyro_scale", "the gyro's axes read too much or too little, in proportion to the rate",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<GyroScale>({vector_parameter(settings, "scale")},
                                               Stage::measurement);
          }};
}

}  // namespace photorque
