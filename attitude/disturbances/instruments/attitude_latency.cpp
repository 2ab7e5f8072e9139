// A camera that reports where the platform was.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct AttitudeLatency final : LawOf<AttitudeLatency> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.camera_delay_s += own.parameter(0);
  }
};

}  // namespace

DisturbanceKind attitude_latency_kind() {
  return {"attitude_latency", "the camera reports an attitude that is already past",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<AttitudeLatency>({scalar_parameter(settings, "latency_s")},
                                                     Stage::measurement);
          }};
}

}  // namespace photorque
