// Gravity decreases with height: T = 3 g/R up_B × I up_B; in orbit g/R is μ/r³. The field is that
// of a point mass, to first order in the platform's size divided by R.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::gravity_gradient {
namespace {

struct GravityGradient final : TorqueLaw<GravityGradient> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>&, const EvaluationContext<T>& now) const {
    const Vec3Of<T> pull = now.inertia_kg_m2 * now.up_body;
    return 3.0 * now.gravity_gradient_1_s2 * now.up_body.cross(pull);
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<GravityGradient, Stage::torque>(
      {.name = "gravity_gradient",
       .summary = "gravity decreases with height and turns the long axis towards the vertical",
       .screening = {
           .parametrisations = {
               {"gravity weakens with height and turns the longest axis towards the vertical",
                {}}}}});
}

}  // namespace photorque::kinds::gravity_gradient
