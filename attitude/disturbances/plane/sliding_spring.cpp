// A spring or cable that holds a sliding body: F = f − k r.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::sliding_spring {
namespace {

constexpr ScalarKey stiffness("stiffness_N_per_m", Range::not_negative(), "k in F = f − k r");
constexpr KeyOf<2> pull("pull_N", "f, the force at the lab's origin; the equilibrium is at f/k",
                        stiffness.end());

struct SlidingSpring final : ForceLaw<SlidingSpring> {
  template <class T>
  Vec3Of<T> force(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T>& r = now.position_lab_m;
    return {own.element(pull, 0) - own[stiffness] * r[0],
            own.element(pull, 1) - own[stiffness] * r[1], T(0.0)};
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<SlidingSpring, Stage::torque, stiffness, pull>(
      {.name = "sliding_spring",
       .summary = "a spring or cable pulls a sliding body back to one place",
       .screening = {.parametrisations = {{"a spring or cable pulls a sliding body back to one "
                                           "place, or a constant force changes along the way",
                                           {EffectKey::not_negative(stiffness.name, 1e-2),
                                            {pull.name, {0.0, 0.0}, 1e-2}}}},
                     .needs = Requirement::plane,
                     .steady = true},
       .budget = {.reason_against = "a force, not a torque"}});
}

}  // namespace photorque::kinds::sliding_spring
