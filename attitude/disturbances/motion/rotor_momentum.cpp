// A wheel, fan or disk that spins at constant speed: T = −ω × h, where ω is the inertial rate.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::rotor_momentum {
namespace {

constexpr VectorKey momentum("momentum_N_m_s",
                             "h in T = −ω × h (ω inertial), relative to the body, body axes");

struct RotorMomentum final : TorqueLaw<RotorMomentum> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return own[momentum].cross(now.inertial_rate_body_rad_s);
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<RotorMomentum, Stage::torque, momentum>(
      {.name = "rotor_momentum",
       .summary = "the angular momentum of a spinning part couples the axes",
       .screening = {
           .parametrisations = {{"a spinning part on board couples the axes like a gyroscope",
                                 {EffectKey::vector(momentum.name, 5e-3)}}}}});
}

}  // namespace photorque::kinds::rotor_momentum
