// A camera that reports a past attitude.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::attitude_latency {
namespace {

constexpr ScalarKey latency("latency_s", {}, "time from a measured attitude to its time stamp");

struct AttitudeLatency final : LawOf<AttitudeLatency> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.camera_delay_s += own[latency];
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<AttitudeLatency, Stage::measurement, latency>(
      {.name = "attitude_latency",
       .summary = "the camera reports a past attitude",
       .screening = {.parametrisations = {{"the camera reports a past attitude",
                                           {EffectKey::not_negative(latency.name, 0.1)}}}},
       .budget = {.reason_against = "an error of an instrument: no torque"},
       .instrument = "camera"});
}

}  // namespace photorque::kinds::attitude_latency
