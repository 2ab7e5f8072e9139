// Thrusters that give a smaller fraction of larger commands, on each body axis of a sliding body:
// the force is F = c / (1 + k |c| / 1 N) instead of the commanded c.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::thrust_saturation {
namespace {

constexpr ScalarKey loss("loss_at_one_newton", Range::not_negative(),
                         "k in F = c/(1 + k |c|/1 N), c the commanded force along a body axis; the "
                         "largest thrust is 1/k newton");

// Makes |c| smooth at zero.
constexpr double least_N = 1e-9;

struct ThrustSaturation final : ForceLaw<ThrustSaturation> {
  template <class T>
  Vec3Of<T> force(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    Vec3Of<T> lost = now.to_body(now.command_lab_N);
    for (int k = 0; k < 3; ++k) {
      const T part = own[loss] * sqrt(lost[k] * lost[k] + T(least_N * least_N));
      lost[k] *= -part / (1.0 + part);
    }
    return now.lab_from_body * lost;
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<ThrustSaturation, Stage::torque, loss>(
      {.name = "thrust_saturation",
       .summary =
           "thrusters give less than commanded, with a fraction that decreases for large commands",
       .screening = {.parametrisations = {{"the thrusters saturate: large commands give a smaller "
                                           "fraction of the commanded force",
                                           {EffectKey::not_negative(loss.name, 1.0)}}},
                     .needs = Requirement::thrust},
       .budget = {.reason_against = "a force, not a torque"}});
}

}  // namespace photorque::kinds::thrust_saturation
