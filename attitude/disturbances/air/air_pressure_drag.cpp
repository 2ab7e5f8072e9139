// Form drag of what stands in the air: T = −k |ω| ω (eq. 22).
//
// coefficient_N_m_s2: k ≥ 0; or one [[disturbance.part]] per body of external_air.h, whose form
// drag about the vertical axis is summed in the environment's air. The law is taken the same about
// every axis.
#include "attitude/disturbances/air/external_air.h"
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct AirPressureDrag final : TorqueLaw<AirPressureDrag> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return -own.parameter(0) * length(now.rate_body_rad_s) * now.rate_body_rad_s;
  }
};

Parameters coefficient(const Settings& settings, const Environment& environment) {
  const std::string key = "coefficient_N_m_s2";
  if (!settings.has("part")) return scalar_parameter(settings, key, Range::not_negative());
  const Air air{environment.air_density_kg_m3, environment.air_viscosity_Pa_s};
  const double k = air_coefficients(read_air_parts(settings.tables("part")), air).form_N_m_s2;
  return fixed_parameter(key, {&k, 1});
}

}  // namespace

DisturbanceKind air_pressure_drag_kind() {
  return {"air_pressure_drag", "form drag of the surrounding air, square of the rate",
          [](const Settings& settings, const DisturbanceContext& context) {
            return make_disturbance<AirPressureDrag>({coefficient(settings, context.environment)});
          }};
}

}  // namespace photorque
