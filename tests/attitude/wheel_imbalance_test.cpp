// A wheel that is not balanced.
#include <gtest/gtest.h>

#include <cmath>

#include "core/errors.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

// A free body that is the same about all axes.
AttitudeModel free_body(double inertia_kg_m2) {
  AttitudeModel model;
  model.platform.topology = Topology::free;
  model.platform.mass_kg = 20.0;
  model.platform.inertia_kg_m2 = inertia_kg_m2 * Mat3::Identity();
  model.environment.gravity_lab_m_s2 = Vec3::Zero();
  return model;
}

Vec3 torque_at(const std::string& keys, double time_s) {
  const AttitudeModel model = with(free_body(1.0), "wheel_imbalance", keys);
  return torque_body_N_m(model, Quat::Identity(), Vec3::Zero(), time_s);
}

// 1 g cm at 3000 rpm pulls with 1e-5 kg m (100π/s)² = 0.98696 N, 1 g cm² turns with 9.8696e-3 N m.
TEST(WheelImbalance, PullsByTheSquareOfItsSpeed) {
  const std::string pulls =
      "axis = [0, 0, 2], static_imbalance_g_cm = 1.0, position_m = [0, 0, 0.2], speed_rpm = 3000.0";
  EXPECT_LT((torque_at(pulls, 0.0) - Vec3(0, 0.2 * 0.98696044, 0)).norm(), 1e-8);
  // A quarter of a turn later, 5 ms, the force is along y.
  EXPECT_LT((torque_at(pulls, 5e-3) - Vec3(-0.2 * 0.98696044, 0, 0)).norm(), 1e-8);
  const std::string turns =
      "axis = [1, 0, 0], dynamic_imbalance_g_cm2 = 1.0, dynamic_phase_deg = 90.0, "
      "speed_rpm = 3000.0";
  EXPECT_LT((torque_at(turns, 0.0) - Vec3(0, 0, 9.8696044e-3)).norm(), 1e-10);
}

// Whatever the speed, a free body swings against the wheel by the angle U_d/I and, about its centre
// of mass, r U_s/I: so much does its part of the angular momentum change.
TEST(WheelImbalance, ABodySwingsByTheSameAngleAtEverySpeed) {
  const double inertia_kg_m2 = 0.5, product_kg_m2 = 4e-7, static_kg_m = 2e-6, arm_m = 0.3;
  for (const double speed_rad_s : {3.0, 100.0, 600.0}) {
    for (const bool is_static : {false, true}) {
      const std::string imbalance = is_static
                                        ? "static_imbalance_g_cm = " + toml(1e5 * static_kg_m) +
                                              ", position_m = [0, 0, " + toml(arm_m) + "]"
                                        : "dynamic_imbalance_g_cm2 = " + toml(1e7 * product_kg_m2);
      const AttitudeModel model =
          with(free_body(inertia_kg_m2), "wheel_imbalance",
               "axis = [0, 0, 1], speed_rad_s = " + toml(speed_rad_s) + ", " + imbalance);
      const double angle_rad = (is_static ? arm_m * static_kg_m : product_kg_m2) / inertia_kg_m2;
      // The torque is along x at t = 0, or along y for a force along x.
      const auto swing = [&](double phase) -> Vec3 {
        const double turned = phase + (is_static ? pi / 2 : 0.0);
        return -angle_rad * Vec3(std::cos(turned), std::sin(turned), 0.0);
      };
      const Vec3 from = swing(0.0);
      const Vec3 rate = speed_rad_s * Vec3(-from.y(), from.x(), 0.0);
      const PlatformState start = state_of(model, turned(from.norm(), from), rate);
      const double turns = 7.3;
      const PlatformState end = propagated(model, start, turns * 2.0 * pi / speed_rad_s);
      const Vec3 to = swing(turns * 2.0 * pi);
      const double off_rad = end.lab_from_body.angularDistance(turned(to.norm(), to));
      // Rotations do not commute: the mean attitude drifts by the square of the angle.
      EXPECT_LT(off_rad, 2.0 * pi * turns * angle_rad * angle_rad) << speed_rad_s << is_static;
      // Half the imbalance is noticed.
      EXPECT_GT(end.lab_from_body.angularDistance(turned(0.5 * to.norm(), to)), 0.4 * angle_rad);
    }
  }
}

// The angle of a wheel that speeds up is Ω t + ½ Ω′ t².
TEST(WheelImbalance, FollowsTheMeasuredSpeed) {
  AttitudeModel model = free_body(1.0);
  model.schedule.append(0.0, {.wheel = {0.0, {0.0, 40.0, 0.0}, {0.0, 2.5, 0.0}}});
  model = with(model, "wheel_imbalance", "axis = [0, 1, 0], dynamic_imbalance_g_cm2 = 30.0");
  const double time_s = 3.0, angle_rad = 40.0 * time_s + 0.5 * 2.5 * time_s * time_s;
  const PlatformState end = propagated(model, state_of(model, Quat::Identity()), time_s);
  const double square = std::pow(40.0 + 2.5 * time_s, 2);
  // y × x = −z.
  const Vec3 expected = 30e-7 * square * Vec3(std::cos(angle_rad), 0.0, -std::sin(angle_rad));
  EXPECT_LT((torque_body_N_m(model, end) - expected).norm(), 1e-8 * expected.norm());
}

TEST(WheelImbalance, RefusesAWheelWithoutImbalanceOrPlace) {
  EXPECT_THROW(torque_at("axis = [0, 0, 1]", 0.0), InputError);
  EXPECT_THROW(torque_at("axis = [0, 0, 1], static_imbalance_g_cm = 1.0", 0.0), InputError);
  EXPECT_THROW(torque_at("axis = [0, 0, 0], dynamic_imbalance_g_cm2 = 1.0", 0), InputError);
}

}  // namespace
}  // namespace photorque
