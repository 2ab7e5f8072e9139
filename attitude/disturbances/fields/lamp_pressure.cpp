// Radiation pressure of lamps in the laboratory: T = torque · (their current / led_current_A). The
// current is a channel of the recording, held from row to row; without it, it is led_current_A. The
// change of the torque with the attitude is not modelled; radiation_pressure has a table for it.
//
// Under constant light, a draught has the torque of lamps. A change of their current distinguishes
// the two.
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
      {parameters_of(settings, torque_lab),
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
