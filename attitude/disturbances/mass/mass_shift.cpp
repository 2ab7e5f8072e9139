// A part slips: the effect of static_unbalance from one instant on.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::mass_shift {
namespace {

constexpr ScalarKey start("time_s", {}, "time of the jump");
constexpr VectorKey offset("offset_m", "displacement of the centre of mass, body axes",
                           start.end());

struct MassShift final : LawOf<MassShift> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const double start_s = values(own[start])[0];
    now.move_mass(active_from(now.time_s, start_s) * own[offset]);
  }

  std::vector<Switch> switches(std::span<const Parameter> parameters) const override {
    return {{parameters[start.first].value, start.first}};
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<MassShift, Stage::mass, start, offset>(
      {.name = "mass_shift",
       .summary = "the centre of mass jumps at one instant",
       .screening = {
           .parametrisations =
               {{"a part of the platform moved at one instant and took the centre of mass with it",
                 {EffectKey::shape(start.name, 0.0, 100.0, 0.0),
                  EffectKey::vector(offset.name, 3e-6)}}},
           .needs = Requirement::gravity,
           .scan = Scan::instant}});
}

}  // namespace photorque::kinds::mass_shift
