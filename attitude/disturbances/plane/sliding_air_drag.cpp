// Form drag of a body that slides through air: F = −k |v| v with k = ½ ρ c_d A.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::sliding_air_drag {
namespace {

constexpr ScalarKey coefficient("coefficient_kg_m", Range::not_negative(), "k in F = −k |v| v");

struct SlidingAirDrag final : ForceLaw<SlidingAirDrag> {
  template <class T>
  Vec3Of<T> force(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return -own[coefficient] * length(now.velocity_lab_m_s) * now.velocity_lab_m_s;
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<SlidingAirDrag, Stage::torque, coefficient>(
      {.name = "sliding_air_drag",
       .summary = "form drag of a body that slides through air, by the square of the speed",
       .screening = {.parametrisations = {{"air drags on a sliding body, by the square of its "
                                           "speed",
                                           {EffectKey::not_negative(coefficient.name, 1e-2)}}},
                     .needs = Requirement::plane},
       .budget = {.reason_against = "a force, not a torque"}});
}

}  // namespace photorque::kinds::sliding_air_drag
