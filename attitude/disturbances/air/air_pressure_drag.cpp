// Form drag of parts in the air: T = −k |ω| ω, or −|ω| diag(k) ω (eq. 22). The form drag of parts
// (external_air.h) is that about the vertical axis.
#include "attitude/disturbances/air/external_air.h"
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::air_pressure_drag {
namespace {

constexpr auto braking =
    ScalarKey("coefficient_N_m_s2", Range::not_negative(),
              "k in T = −k |ω| ω, or three, for body x, y and z; *or* `[[disturbance.part]]`")
        .optional();

struct AirPressureDrag final : TorqueLaw<AirPressureDrag> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return -own[braking] * length(now.rate_body_rad_s) * now.rate_body_rad_s;
  }
};

constexpr VectorKey braking_by_axis{braking.name};

struct AxisDrag final : TorqueLaw<AxisDrag> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T>& w = now.rate_body_rad_s;
    return -length(w) * own[braking_by_axis].cwiseProduct(w);
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  if (settings.has(braking.name) && count_as_written(settings, braking.name) > 0) {
    return make_disturbance<AxisDrag>({parameters_of(settings, braking_by_axis)});
  }
  return make_disturbance<AirPressureDrag>(
      {coefficient_of_air(settings, context.environment, braking, &AirCoefficients::form_N_m_s2)});
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "air_pressure_drag",
      .summary = "form drag of the surrounding air, square of the rate",
      .read = read,
      .screening = {.parametrisations =
                        {{"form drag of the surrounding air brakes with the square of the rate",
                          {EffectKey::not_negative(braking.name, 1e-3)}},
                         {"air resists each axis as its shape does, with the square of the rate",
                          {EffectKey::vector_not_negative(braking.name, 1e-3)},
                          true}}},
      .budget = {.paper_figure = "cfd_drag_at_1_rpm_N_m"},
      .keys = {Key(braking).one_or_several(3), air_parts_key()}};
}

}  // namespace photorque::kinds::air_pressure_drag
