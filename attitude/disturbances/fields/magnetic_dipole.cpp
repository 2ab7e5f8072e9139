// A dipole in the ambient field: T = m × B_B (eq. 26–28). Remanent steel and current loops
// (coil_cage.h) have equal effects.
#include "attitude/disturbances/fields/coil_cage.h"
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::magnetic_dipole {
namespace {

constexpr auto moment =
    VectorKey("dipole_A_m2", "m in T = m × B, body axes; *or* the loops").optional();

constexpr TablesKey loops("loop", "current loops, summed");

struct MagneticDipole final : TorqueLaw<MagneticDipole> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return own[moment].cross(now.magnetic_field_body_T);
  }
};

PlacedParameters dipole(const Settings& settings) {
  if (!settings.has(loops)) return parameters_of(settings, moment);
  const Vec3 sum_A_m2 = dipole_A_m2(read_current_loops(settings.get(loops)));
  return fixed_parameter(moment.name, {sum_A_m2.data(), 3});
}

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  return make_disturbance<MagneticDipole>({dipole(settings)});
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "magnetic_dipole",
          .summary = "current loops and remanent steel turn towards the ambient field",
          .read = read,
          .screening =
              {.parametrisations =
                   {{"a residual magnetic dipole of the platform turns towards the ambient field",
                     {EffectKey::vector(moment.name, 0.05)}}},
               .needs = Requirement::field},
          .keys = {moment, loops.of(current_loop_keys())}};
}

}  // namespace photorque::kinds::magnetic_dipole
