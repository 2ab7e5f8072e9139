// The centre of mass beside the centre of rotation: T = m r × g_B.
//
// offset_m[3]: from the centre of rotation, body axes. A platform that is stable at zero tilt has a
// negative third component.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct StaticUnbalance final : LawOf<StaticUnbalance> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.move_mass(own.vector(0));
  }
};

}  // namespace

DisturbanceKind static_unbalance_kind() {
  return {"static_unbalance", "the centre of mass does not lie in the centre of rotation",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<StaticUnbalance>({vector_parameter(settings, "offset_m")},
                                                     Stage::mass);
          }};
}

}  // namespace photorque
