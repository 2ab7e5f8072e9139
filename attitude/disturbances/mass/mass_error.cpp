// The mass is m + δ instead of the nominal m.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::mass_error {
namespace {

constexpr ScalarKey delta("delta_kg", {}, "deviation of the mass; the sum must be positive");

struct MassError final : LawOf<MassError> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.mass_kg += own[delta];
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  const PlacedParameters read = parameters_of(settings, delta);
  const double mass_kg = context.platform.mass_kg + read.parameters.front().value;
  if (!(mass_kg > 0.0)) {
    throw settings.error(delta.name, "a mass of " + std::to_string(mass_kg) + " kg with it",
                         "a mass above zero");
  }
  return make_disturbance<MassError>({read}, Stage::conditions);
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "mass_error",
      .summary = "the mass differs from the stated one",
      .read = read,
      .screening = {.reason_against = "`static_unbalance` and `actuator_gain` have the same effect",
                    .changes_mass = true},
      .budget = {.reason_against = "it exerts no torque"},
      .keys = {delta}};
}

}  // namespace photorque::kinds::mass_error
