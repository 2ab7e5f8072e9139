// The centre of mass differs from the centre of rotation: T = m r × g_B.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::static_unbalance {
namespace {

constexpr VectorKey offset("offset_m",
                           "r in T = m r × g, from the centre of rotation, body axes; z is "
                           "negative for a stable platform");

struct StaticUnbalance final : LawOf<StaticUnbalance> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.move_mass(own[offset]);
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<StaticUnbalance, Stage::mass, offset>(
      {.name = "static_unbalance",
       .summary = "the centre of mass does not lie in the centre of rotation",
       .screening = {
           .parametrisations =
               {{"the centre of mass differs from the stated one by more than its uncertainty",
                 {EffectKey::vector(offset.name, 5e-6)}}},
           .needs = Requirement::gravity}});
}

}  // namespace photorque::kinds::static_unbalance
