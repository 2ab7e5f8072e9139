// Laminar boundary layers on a rotating body: T = −k |ω|^½ ω (eq. 18, 20, 21), about all axes. The
// friction of parts (external_air.h) is that about the vertical axis, for the air of the
// environment.
#include "attitude/disturbances/air/external_air.h"
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::air_friction {
namespace {

constexpr auto braking = ScalarKey("coefficient", Range::not_negative(),
                                   "k in T = −k |ω|^½ ω, N m s^1.5; *or* `[[disturbance.part]]`")
                             .optional();

struct AirFriction final : TorqueLaw<AirFriction> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return -own[braking] * sqrt(length(now.rate_body_rad_s)) * now.rate_body_rad_s;
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  return make_disturbance<AirFriction>({coefficient_of_air(settings, context.environment, braking,
                                                           &AirCoefficients::friction_N_m_s1_5)});
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "air_friction",
          .summary = "laminar boundary layers of the surrounding air, power 1.5 of the rate",
          .read = read,
          .screening = {.parametrisations = {{"laminar boundary layers of the surrounding air "
                                              "brake with the power 1.5 of the rate",
                                              {EffectKey::not_negative(braking.name, 5e-5)}}}},
          .budget = {.paper_figure = "lumped_drag_at_1_rpm_N_m"},
          .keys = {braking, air_parts_key()}};
}

}  // namespace photorque::kinds::air_friction
