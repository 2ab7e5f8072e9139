// Something slips: the same as static_unbalance, from one instant on.
//
// time_s: the instant. offset_m[3]: what the centre of mass moves by, body axes.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct MassShift final : LawOf<MassShift> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const double start_s = values(own.parameter(0))[0];
    now.move_mass(active_from(now.time_s, start_s) * own.vector(1));
  }

  std::vector<Switch> switches(std::span<const Parameter> parameters, double from_s,
                               double to_s) const override {
    const double start_s = parameters[0].value;
    if (start_s > from_s && start_s < to_s) return {{start_s, 0}};
    return {};
  }
};

}  // namespace

DisturbanceKind mass_shift_kind() {
  return {"mass_shift", "the centre of mass jumps at one instant",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<MassShift>(
                {scalar_parameter(settings, "time_s"), vector_parameter(settings, "offset_m")},
                Stage::mass);
          }};
}

}  // namespace photorque
