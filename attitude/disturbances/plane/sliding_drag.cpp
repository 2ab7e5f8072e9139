// Viscous drag of a sliding body, for example of an air film: F = −c v.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::sliding_drag {
namespace {

constexpr ScalarKey coefficient("coefficient_kg_s", Range::not_negative(), "c in F = −c v");

struct SlidingDrag final : ForceLaw<SlidingDrag> {
  template <class T>
  Vec3Of<T> force(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return -own[coefficient] * now.velocity_lab_m_s;
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<SlidingDrag, Stage::torque, coefficient>(
      {.name = "sliding_drag",
       .summary = "viscous drag of a sliding body, linear in the speed",
       .screening = {.parametrisations = {{"viscous drag on a sliding body, by an air film or a "
                                           "liquid, in proportion to its speed",
                                           {EffectKey::not_negative(coefficient.name, 1e-2)}}},
                     .needs = Requirement::plane},
       .budget = {.reason_against = "a force, not a torque"}});
}

}  // namespace photorque::kinds::sliding_drag
