// A gyro that reads a constant rate at rest.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct GyroBias final : LawOf<GyroBias> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.gyro_error_rad_s += own.vector(0);
  }
};

}  // namespace

DisturbanceKind gyro_bias_kind() {
  return {"gyro_bias", "the gyro reads a constant rate at rest",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<GyroBias>({vector_parameter(settings, "bias_rad_s")},
                                              Stage::measurement);
          }};
}

}  // namespace photorque
