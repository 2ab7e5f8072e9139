// A dipole in the ambient field: T = m × B_B (eq. 26–28).
//
// dipole_A_m2[3]: body axes; or one [[disturbance.loop]] per current loop of current_loop.h
// (current_A, turns, area_m2[3] or corners_m), summed. Remanent steel and loops look the same.
#include "attitude/disturbances/fields/current_loop.h"
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct MagneticDipole final : TorqueLaw<MagneticDipole> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return own.vector(0).cross(now.magnetic_field_body_T);
  }
};

Parameters dipole(const Settings& settings) {
  if (!settings.has("loop")) return vector_parameter(settings, "dipole_A_m2");
  const Vec3 sum_A_m2 = dipole_A_m2(read_current_loops(settings.tables("loop")));
  return fixed_parameter("dipole_A_m2", {sum_A_m2.data(), 3});
}

}  // namespace

DisturbanceKind magnetic_dipole_kind() {
  return {"magnetic_dipole", "current loops and remanent steel turn towards the ambient field",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<MagneticDipole>({dipole(settings)});
          }};
}

}  // namespace photorque
