// A cable or hose that pulls back to zero attitude: T = −k × the rotation vector from it.
//
// stiffness_N_m_per_rad: k ≥ 0, the same about every axis, no hysteresis. Smooth below half a turn,
// where the shortest way back changes side.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct Tether final : TorqueLaw<Tether> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const QuatOf<T>& q = now.attitude;
    // q and −q are the same attitude; the one with w ≥ 0 is the short way.
    const T side = where_at_least(q.w(), 0.0, T(1.0), T(-1.0));
    const Vec3Of<T> v = side * q.vec();
    const T sine = length(v);
    return -own.parameter(0) * (2.0 * atan2(sine, side * q.w()) / sine) * v;
  }
};

}  // namespace

DisturbanceKind tether_kind() {
  return {"tether", "a cable pulls back to zero attitude",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<Tether>(
                {scalar_parameter(settings, "stiffness_N_m_per_rad", Range::not_negative())});
          }};
}

}  // namespace photorque
