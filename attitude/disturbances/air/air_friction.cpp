// Laminar boundary layers on what turns: T = −k |ω|^½ ω (eq. 18, 20, 21).
//
// coefficient: k ≥ 0 [N m s^1.5]; or one [[disturbance.part]] per body of external_air.h, whose
// friction about the vertical axis is summed in the environment's air. The law is taken the same
// about every axis.
#include "attitude/disturbances/air/external_air.h"
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct AirFriction final : TorqueLaw<AirFriction> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return -own.parameter(0) * sqrt(length(now.rate_body_rad_s)) * now.rate_body_rad_s;
  }
};

Parameters coefficient(const Settings& settings, const Environment& environment) {
  if (!settings.has("part"))
    return scalar_parameter(settings, "coefficient", Range::not_negative());
  const Air air{environment.air_density_kg_m3, environment.air_viscosity_Pa_s};
  const double k = air_coefficients(read_air_parts(settings.tables("part")), air).friction_N_m_s1_5;
  return fixed_parameter("coefficient", {&k, 1});
}

}  // namespace

DisturbanceKind air_friction_kind() {
  return {"air_friction", "laminar boundary layers of the surrounding air, power 1.5 of the rate",
          [](const Settings& settings, const DisturbanceContext& context) {
            return make_disturbance<AirFriction>({coefficient(settings, context.environment)});
          }};
}

}  // namespace photorque
