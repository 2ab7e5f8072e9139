// The current of the lamps in the schedule, and the torque that is proportional to it.
#include <gtest/gtest.h>

#include "attitude/recordings/recording.h"
#include "core/constants.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/files.h"

namespace photorque {
namespace {

Schedule schedule_of(const std::string& rows) {
  return read_command_file(test_file("lamps.csv", "t_s,led_current_A\n" + rows));
}

TEST(LampCurrent, HoldsUntilItChangesByMoreThanItsNoise) {
  const Schedule s =
      schedule_of("0,0.700\n1,0.702\n2,0.698\n3,\n4,0.349\n5,0.351\n6,-0.001\n7,0.7\n");
  const double expected_A[] = {0.6995, 0.6995, 0.6995, 0.6995, 0.35, 0.35, 0.0, 0.7};
  for (int t = 0; t < 8; ++t) {
    EXPECT_DOUBLE_EQ(s.at(t).led_current_A, expected_A[t]) << t;
    EXPECT_EQ(s.at(t).lamps_as_stated, 0.0);
  }
  // One entry of the schedule for each change.
  EXPECT_EQ(s.time_s.size(), 4u);
}

TEST(LampCurrent, IsNotKnownWithoutAChannel) {
  EXPECT_EQ(ZeroOrderHold{}.lamps_as_stated, 1.0);
  EXPECT_EQ(ZeroOrderHold{}.led_current_A, 0.0);
}

// Half the current gives half the torque, along lab axes. An unknown current gives the whole
// torque.
TEST(LampPressureLaw, IsProportionalToTheCurrent) {
  const auto torque_body = [](const ZeroOrderHold& held) {
    AttitudeModel model = bench_model();
    model.disturbances.clear();
    model.schedule.append(0.0, held);
    model =
        with(model, "lamp_pressure", "torque_lab_N_m = [1e-5, -2e-5, 3e-5], led_current_A = 0.7");
    // After a quarter turn about the vertical, lab x is the body's −y and lab y its x.
    return torque_body_N_m(model, turned(0.5 * pi, Vec3::UnitZ()));
  };
  const Vec3 half = torque_body({.led_current_A = 0.35, .lamps_as_stated = 0.0}),
             unknown = torque_body({}), dark = torque_body({.lamps_as_stated = 0.0});
  EXPECT_LT((half - Vec3(-1e-5, -0.5e-5, 1.5e-5)).norm(), 1e-19);
  EXPECT_LT((unknown - Vec3(-2e-5, -1e-5, 3e-5)).norm(), 1e-19);
  EXPECT_EQ(dark.norm(), 0.0);
}

}  // namespace
}  // namespace photorque
