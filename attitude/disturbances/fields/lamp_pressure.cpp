// The light of lamps that stand in the laboratory pushes: T = torque · (their current over that of
// the key).
//
// torque_lab_N_m[3]: lab axes, where the lamps draw led_current_A. Their current is a channel of
// the recording and holds from row to row; where there is none they shine at that current. A body
// that leans or turns far meets other light; this is the part that does not change with that. Its
// table with attitude is radiation_pressure.
//
// A draught is the same torque where the light never changes. Where lamps are dimmed or switched,
// their current separates the two.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::lamp_pressure {
namespace {

constexpr VectorKey torque_lab("torque_lab_N_m", "torque at the current `led_current_A`, lab axes");

namespace key {
constexpr NumberKey led_current("led_current_A", Range::positive(),
                                "current of the lamps at which they exert `torque_lab_N_m`");
}  // namespace key
constexpr ScalarKey led_current("led_current_A", torque_lab.end());

struct LampPressure final : TorqueLaw<LampPressure> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T> at_that_current = own[torque_lab];
    const T light = now.lamps_as_stated + now.led_current_A / own[led_current];
    return now.to_body(light * at_that_current);
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  const double at_A[] = {settings.number(led_current.name, Range::positive())};
  return make_disturbance<LampPressure>(
      {vector_parameter(settings, torque_lab),
       fixed_parameter(led_current.name, at_A, led_current.first)});
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "lamp_pressure",
      .summary = "the laboratory's lamps exert radiation pressure, in proportion to their light",
      .read = read,
      .screening = {.parametrisations = {{"the light of the lamps exerts a torque, constant in "
                                          "the laboratory but for their brightness",
                                          {EffectKey::vector(torque_lab.name, 5e-6),
                                           EffectKey::largest_recorded(led_current.name)}}},
                    .needs = Requirement::lamps},
      .budget = {.reason_against = "depends on the light at the instant"},
      .keys = {torque_lab, key::led_current}};
}

}  // namespace photorque::kinds::lamp_pressure
