// A steady draught in the room: a torque that is constant in the lab.
//
// torque_lab_N_m[3]. A platform whose shape matters to the draught feels other torques at other
// headings; this is the part that does not turn with it.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

struct RoomDraft final : TorqueLaw<RoomDraft> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return now.to_body(own.vector(0));
  }
};

}  // namespace

DisturbanceKind room_draft_kind() {
  return {"room_draft", "a steady draught: a torque constant in the lab",
          [](const Settings& settings, const DisturbanceContext&) {
            return make_disturbance<RoomDraft>({vector_parameter(settings, "torque_lab_N_m")});
          }};
}

}  // namespace photorque
