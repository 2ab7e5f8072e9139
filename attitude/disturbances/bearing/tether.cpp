// A cable or hose that pulls back to zero attitude: T = −k × the rotation vector from it.
//
// stiffness_N_m_per_rad: k ≥ 0, the same about every axis, no hysteresis. Smooth below half a turn,
// where the shortest way back changes side.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

constexpr ScalarKey stiffness{"stiffness_N_m_per_rad"};

struct Tether final : TorqueLaw<Tether> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const QuatOf<T>& q = now.attitude;
    // q and −q are the same attitude; the one with w ≥ 0 is the short way.
    const T side = where_at_least(q.w(), 0.0, T(1.0), T(-1.0));
    const Vec3Of<T> v = side * q.vec();
    const T sine = length(v);
    return -own[stiffness] * (2.0 * atan2(sine, side * q.w()) / sine) * v;
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  return make_disturbance<Tether>({scalar_parameter(settings, stiffness, Range::not_negative())});
}

// The law again, for `prove`.
injected::PlainTorque plain_torque(const InjectedEffect& effect) {
  using namespace injected;
  return [k = effect.number(stiffness.name)](const Surroundings& s) {
    return times(-k, turn_of(s.attitude));
  };
}

}  // namespace

DisturbanceKind tether_kind() {
  return {.name = "tether",
          .summary = "a cable pulls back to zero attitude",
          .read = read,
          .screening = {.parametrisations = {{"a cable pulls the platform back to zero attitude",
                                              {EffectKey::not_negative(stiffness.name, 1e-5)}}}},
          .injection = {.draw = injected::fixed_size(stiffness.name, 3e-5),
                        .torque = plain_torque,
                        .strength = stiffness.name,
                        .step = 1e-8,
                        .needs_small_turns = true,
                        .pairs = true}};
}

}  // namespace photorque
