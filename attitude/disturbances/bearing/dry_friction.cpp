// Friction with a magnitude that does not depend on the rate: T = −τ ω/|ω|, a bearing that touches.
//
// For a platform with one axis, the propagator keeps the direction of slip constant within a step
// and ends steps at sign changes of the rate. The platform then sticks until the other torques
// exceed τ (attitude/propagation/dry_contact.h). About three axes, the torque decreases linearly to
// zero at small rates, so that the law has a derivative at rest: T = −τ ω/√(ω² + creep²). Sticking
// is then a creep that is too slow to be measured.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::dry_friction {
namespace {

constexpr ScalarKey friction("torque_N_m", Range::not_negative(), "τ in T = −τ ω/√(ω² + creep²)");

namespace key {
constexpr NumberKey creep_rate(
    "creep_rate_rad_s", 1e-6, Range::positive(),
    "rate below which the torque decreases to zero (rotation about three axes only)");
}  // namespace key

class DryFriction final : public TorqueLaw<DryFriction> {
 public:
  explicit DryFriction(double creep_rate_rad_s) : creep_rate_rad_s_(creep_rate_rad_s) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T>& w = now.rate_body_rad_s;
    const T speed = sqrt(w.dot(w) + T(creep_rate_rad_s_ * creep_rate_rad_s_));
    const Vec3Of<T> by_rate = (1.0 / speed) * w;
    const Vec3Of<T> held = now.slip_sign * now.platform.axis.template cast<T>();
    return -own[friction] * Vec3Of<T>(by_rate + now.slip_is_held * Vec3Of<T>(held - by_rate));
  }

 private:
  double creep_rate_rad_s_;
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  Disturbance d = make_disturbance<DryFriction>({parameters_of(settings, friction)}, Stage::torque,
                                                {}, settings.get(key::creep_rate));
  d.is_abrupt = true;
  d.is_dry_friction = true;
  return d;
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "dry_friction",
          .summary = "dry contact: a torque against the motion, independent of the rate",
          .read = read,
          .screening = {.parametrisations = {{"a contact brakes with a torque of constant size",
                                              {EffectKey::not_negative(friction.name, 5e-6)}}},
                        .needs = Requirement::bearing},
          .keys = {friction, key::creep_rate}};
}

}  // namespace photorque::kinds::dry_friction
