// A force that rotates with a sliding body, F = R f, for example of a leaking thruster or of an air
// jet on the platform.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::body_force {
namespace {

constexpr KeyOf<2> force_body("force_N", "along body x and y");

struct BodyForce final : ForceLaw<BodyForce> {
  template <class T>
  Vec3Of<T> force(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return now.lab_from_body *
           Vec3Of<T>(own.element(force_body, 0), own.element(force_body, 1), T(0.0));
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<BodyForce, Stage::torque, force_body>(
      {.name = "body_force",
       .summary = "a constant force that turns with a sliding body",
       .screening = {.parametrisations = {{"a constant force acts that turns with the platform: "
                                           "a leaking thruster, a hose, a fan on board",
                                           {{force_body.name, {0.0, 0.0}, 1e-2}}}},
                     .needs = Requirement::plane},
       .budget = {.reason_against = "a force, not a torque"}});
}

}  // namespace photorque::kinds::body_force
