// A steady draught in the room: a torque that is constant in the lab. The part of the torque that
// changes with the attitude, due to the shape of the platform, is not modelled.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::room_draft {
namespace {

constexpr VectorKey torque_lab("torque_lab_N_m", "torque, lab axes");

struct RoomDraft final : TorqueLaw<RoomDraft> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return now.to_body(own[torque_lab]);
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<RoomDraft, Stage::torque, torque_lab>(
      {.name = "room_draft",
       .summary = "a steady draught: a torque constant in the lab",
       .screening = {
           .parametrisations =
               {{"a torque that is constant in the laboratory: a steady draught, or a drive",
                 {EffectKey::vector(torque_lab.name, 5e-6)}}},
           .needs = Requirement::laboratory,
           .steady = true}});
}

}  // namespace photorque::kinds::room_draft
