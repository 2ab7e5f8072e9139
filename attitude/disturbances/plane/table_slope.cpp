// A table that is not level: F = −m g (s_x, s_y) on a platform that slides. A steady draught or
// another constant force has the same effect.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::table_slope {
namespace {

constexpr KeyOf<2> slope("slope_rad", "slope of the table along lab x and y (small angles)");

struct TableSlope final : ForceLaw<TableSlope> {
  template <class T>
  Vec3Of<T> force(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const T weight = now.mass_kg * now.gravity_lab_m_s2[2];  // downwards: negative
    return {weight * own.element(slope, 0), weight * own.element(slope, 1), T(0.0)};
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<TableSlope, Stage::torque, slope>(
      {.name = "table_slope",
       .summary = "the table is not level: a constant acceleration",
       .screening = {.parametrisations = {{"a constant acceleration, the slope times gravity: "
                                           "the table is not level, or another constant force "
                                           "acts",
                                           {{slope.name, {0.0, 0.0}, 1e-3}}}},
                     .needs = Requirement::plane,
                     .steady = true},
       .budget = {.reason_against = "a force, not a torque"}});
}

}  // namespace photorque::kinds::table_slope
