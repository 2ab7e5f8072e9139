// A sinusoidal torque in body axes: T = T₀ sin(2π f t + φ).
//
// torque_N_m[3], frequency_Hz, phase [rad] (or phase_deg; default 0).
#include "attitude/disturbances/kind.h"
#include "attitude/disturbances/sinusoid.h"

namespace photorque {
namespace {

struct PeriodicTorque final : TorqueLaw<PeriodicTorque> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return sinusoid(now.time_s, own.parameter(3), own.parameter(4)) * own.vector(0);
  }
};

}  // namespace

DisturbanceKind periodic_torque_kind() {
  return {"periodic_torque", "something on board shakes at one frequency",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<PeriodicTorque>(
                {vector_parameter(settings, "torque_N_m"),
                 scalar_parameter(settings, "frequency_Hz", Range::not_negative()),
                 phase_parameter(settings)});
          }};
}

}  // namespace photorque
