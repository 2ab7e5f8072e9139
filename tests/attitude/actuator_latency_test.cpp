// Commands that act later than they are given.
#include <gtest/gtest.h>

#include "attitude/propagation/run.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

// A free body that is turned about z by 2e-4 N m from 1 s to 4 s.
AttitudeModel commanded() {
  AttitudeModel model;
  model.platform.topology = Topology::free;
  model.platform.mass_kg = 7.0;
  model.platform.inertia_kg_m2 = Vec3(0.11, 0.12, 0.2).asDiagonal();
  model.schedule.append(1.0, {.command_body_N_m = {0, 0, 2e-4}, .battery_current_A = 3.0});
  model.schedule.append(4.0, {});
  return model;
}

double yaw_rate_rad_s(const AttitudeModel& model, double time_s) {
  return propagated(model, state_of(model, Quat::Identity()), time_s).rate_body_rad_s.z();
}

// A double integrator: the rate is 1e-3 rad/s² times the time that the torque has acted.
TEST(ActuatorLatency, ATorqueActsLater) {
  for (const double latency_s : {0.1, 0.3, 2.0, 5.0}) {
    const AttitudeModel model =
        with(commanded(), "actuator_latency", "latency_s = " + toml(latency_s));
    for (const double time_s : {0.9, 1.05, 2.0, 3.7, 4.1, 7.0, 9.5}) {
      const double acted_s = std::clamp(time_s - 1.0 - latency_s, 0.0, 3.0);
      EXPECT_NEAR(yaw_rate_rad_s(model, time_s), 1e-3 * acted_s, 1e-15) << latency_s << time_s;
    }
  }
  EXPECT_NEAR(yaw_rate_rad_s(commanded(), 2.0), 1e-3, 1e-15);
}

// The battery's current is no command, and several delays add up.
TEST(ActuatorLatency, DelaysAddUpAndCurrentsDoNotWait) {
  AttitudeModel model = with(commanded(), "actuator_latency", "latency_s = 0.2");
  model = with(model, "actuator_latency", "latency_ms = 300.0");
  EXPECT_NEAR(yaw_rate_rad_s(model, 2.0), 0.5e-3, 1e-15);
  const PlatformState end = propagated(model, state_of(model, Quat::Identity()), 2.0);
  EXPECT_NEAR(end.charge_drawn_C, 3.0, 1e-12);
}

// A recording holds commands when they were given, so that a model with this latency explains it.
TEST(ActuatorLatency, RecordingsHoldTheCommandsAsGiven) {
  PropagationRun run;
  run.model = with(commanded(), "actuator_latency", "latency_s = 0.5");
  run.initial = state_of(run.model, Quat::Identity());
  run.duration_s = 3.0;
  run.output_rate_Hz = 20.0;
  const Recording recording = propagate(run).recording;
  const Channel* command = recording.find("command_z_N_m");
  ASSERT_NE(command, nullptr);
  for (size_t row = 0; row < recording.rows(); ++row) {
    const double expected_N_m = recording.time_s[row] > 1.0 - 1e-9 ? 2e-4 : 0.0;
    EXPECT_EQ(command->values[row], expected_N_m) << recording.time_s[row];
  }
}

// Rounding of the shifted times takes no command to the other side of its jump.
TEST(ActuatorLatency, NoCommandIsLostByRounding) {
  AttitudeModel model;
  model.platform.topology = Topology::free;
  model.platform.inertia_kg_m2 = Vec3(0.11, 0.12, 0.2).asDiagonal();
  constexpr int steps = 200;
  double sum_N_m_s = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double torque_N_m = 1e-5 * ((7 * i) % 11 - 5);
    model.schedule.append(0.1 * i, {.command_body_N_m = {0, 0, torque_N_m}});
    sum_N_m_s += 0.1 * torque_N_m;
  }
  model.schedule.append(0.1 * steps, {});
  model = with(model, "actuator_latency", "latency_s = 0.07");
  EXPECT_NEAR(0.2 * yaw_rate_rad_s(model, 0.1 * steps + 1.0), sum_N_m_s, 1e-15);
}

}  // namespace
}  // namespace photorque
