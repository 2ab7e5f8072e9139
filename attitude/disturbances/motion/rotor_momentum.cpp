// A wheel, fan or disk that spins at constant speed: T = −ω × h, ω the inertial rate.
//
// momentum_N_m_s[3]: angular momentum relative to the body, body axes.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct RotorMomentum final : TorqueLaw<RotorMomentum> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return own.vector(0).cross(now.inertial_rate_body_rad_s);
  }
};

}  // namespace

DisturbanceKind rotor_momentum_kind() {
  return {"rotor_momentum", "a spinning part resists being turned",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<RotorMomentum>({vector_parameter(settings, "momentum_N_m_s")});
          }};
}

}  // namespace photorque
