// Actuators act later than they are commanded. Before the first command, torques and forces are
// zero. The latency of a camera is attitude_latency; the controller of wheel_control acts at once.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::actuator_latency {
namespace {

namespace key {
constexpr NumberKey latency("latency_s", Range::not_negative(),
                            "time from a command to its torque or force");
}  // namespace key

// The delay is one of the schedule: Disturbance::command_delay_s.
Disturbance read(const Settings& settings, const DisturbanceContext&) {
  Disturbance disturbance = make_disturbance<NoLaw>({}, Stage::conditions);
  disturbance.command_delay_s = settings.get(key::latency);
  return disturbance;
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "actuator_latency",
          .summary = "actuators act later than they are commanded",
          .read = read,
          .screening = {.reason_against = "a delay of commands is no parameter of the fit"},
          .budget = {.reason_against = "depends on the commands before the instant"},
          .keys = {key::latency}};
}

}  // namespace photorque::kinds::actuator_latency
