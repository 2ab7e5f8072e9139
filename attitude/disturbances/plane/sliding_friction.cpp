// Dry friction of a sliding body: F = −μ m g v/|v|. Below a speed of 1e-4 m/s the friction
// decreases with the speed, so that a platform at rest creeps with at most about this speed.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::sliding_friction {
namespace {

constexpr ScalarKey coefficient("coefficient", Range::not_negative(), "μ in F = −μ m g v/|v|");

struct SlidingFriction final : ForceLaw<SlidingFriction> {
  template <class T>
  Vec3Of<T> force(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    constexpr double creep_m_s = 1e-4;
    const Vec3Of<T>& v = now.velocity_lab_m_s;
    const T speed = sqrt(T(v.dot(v) + creep_m_s * creep_m_s));
    return (own[coefficient] * now.mass_kg * now.gravity_lab_m_s2[2] / speed) * v;
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  Disturbance d = make_disturbance<SlidingFriction>({parameters_of(settings, coefficient)});
  d.is_abrupt = true;
  return d;
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "sliding_friction",
      .summary = "dry friction of a sliding body, equal at every speed",
      .read = read,
      .screening = {.parametrisations = {{"dry friction brakes a sliding body, equally at every "
                                          "speed",
                                          {EffectKey::not_negative(coefficient.name, 1e-3)}}},
                    .needs = Requirement::plane},
      .budget = {.reason_against = "a force, not a torque"},
      .keys = {coefficient}};
}

}  // namespace photorque::kinds::sliding_friction
