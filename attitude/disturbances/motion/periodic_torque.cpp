// A sinusoidal torque in body axes: T = T₀ sin(2π f t + φ).
#include "attitude/disturbances/kind.h"
#include "attitude/disturbances/motion/vibration.h"

namespace photorque::kinds::periodic_torque {
namespace {

// At higher frequencies the phase loses its precision within a day: the steps would sample a slow
// alias.
constexpr Range tone_Hz{0.0, 1e6};
constexpr VectorKey amplitude("torque_N_m", "T₀ in T = T₀ sin(2π f t + φ), body axes");
constexpr ScalarKey frequency("frequency_Hz", tone_Hz, "frequency f of the torque",
                              amplitude.end());
constexpr ScalarKey phase("phase", 0.0, {}, "phase φ at t = 0, rad; or `phase_deg`",
                          frequency.end());

namespace key {
constexpr UncertainNumberKey phase("phase_deg", {}, "phase in degrees, instead of `phase`",
                                   {.optional = true});
}  // namespace key

struct PeriodicTorque final : TorqueLaw<PeriodicTorque> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return sinusoid(now.time_s, own[frequency], own[phase]) * own[amplitude];
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  return make_disturbance<PeriodicTorque>({parameters_of(settings, amplitude),
                                           parameters_of(settings, frequency),
                                           phase_parameter(settings, phase)});
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "periodic_torque",
      .summary = "a sinusoidal torque in body axes, as of a machine on board",
      .read = read,
      .screening = {.parametrisations = {{"a machine on board causes a torque at one frequency",
                                          {EffectKey::vector(amplitude.name, 5e-5),
                                           EffectKey::shape(frequency.name, 1.0, 5.0, 0.0, 100.0),
                                           EffectKey::shape(phase.name, 0.0, phase_scale,
                                                            -EffectKey::unbounded)}}},
                    .scan = Scan::frequency,
                    .fast = true},
      .keys = {amplitude, frequency, phase, key::phase}};
}

}  // namespace photorque::kinds::periodic_torque
