// Torques from on board and from the room: rotors, springs, shakers, actuators, swirl and draught.
#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

// A symmetric gyrostat precesses: in body axes its transverse rate turns at
// ((I_s − I_t) ω_s + h)/I_t (Hughes, Spacecraft Attitude Dynamics, § 6.1).
TEST(RotorMomentum, GyrostatPrecessesAtTheClosedFormRate) {
  AttitudeModel model;
  model.platform.inertia_kg_m2 = Vec3(0.12, 0.12, 0.19).asDiagonal();
  model = with(model, "rotor_momentum", "momentum_N_m_s = [0, 0, 0.05]");
  const PlatformState end =
      propagated(model, state_of(model, Quat::Identity(), {0.02, 0, 0.1}), 7.0);
  const double angle = ((0.19 - 0.12) * 0.1 + 0.05) / 0.12 * 7.0;
  EXPECT_NEAR(end.rate_body_rad_s.x(), 0.02 * std::cos(angle), 1e-12);
  EXPECT_NEAR(end.rate_body_rad_s.y(), 0.02 * std::sin(angle), 1e-12);
  EXPECT_NEAR(end.rate_body_rad_s.z(), 0.1, 1e-13);
}

TEST(Tether, TwistsWithThePeriodOfATorsionSpring) {
  const AttitudeModel model = with(bench_model(), "tether", "stiffness_N_m_per_rad = 2e-4");
  // For a rotation about a principal axis, the law is linear at all angles below half a turn.
  const double half_period_s = pi * std::sqrt(0.19 / 2e-4);
  const PlatformState end =
      propagated(model, state_of(model, turned(2.5, Vec3::UnitZ())), half_period_s);
  EXPECT_LT(end.lab_from_body.angularDistance(turned(-2.5, Vec3::UnitZ())), 1e-8);
}

TEST(Tether, PullsAlongTheRotationVector) {
  const AttitudeModel model = with(bench_model(), "tether", "stiffness_N_m_per_rad = 2e-4");
  const Vec3 axis = Vec3(1, -2, 2) / 3;
  for (const double angle : {1e-9, 0.3, 3.0}) {
    const Quat q = turned(angle, axis);
    const Vec3 expected = -2e-4 * angle * axis;
    EXPECT_LT((torque_body_N_m(model, q) - expected).norm(), 1e-12 * expected.norm());
  }
}

// J ω(t) = ∫ T₀ sin(2πft + φ) dt.
TEST(PeriodicTorque, IntegratesToTheClosedFormRate) {
  const AttitudeModel model = with(bench_model(), "periodic_torque",
                                   "torque_N_m = [0, 0, 5e-5], frequency_Hz = 1.179, phase = 2.6");
  const double w = 2 * pi * 1.179, t = 33.3;
  const double expected = 5e-5 / (0.19 * w) * (std::cos(2.6) - std::cos(w * t + 2.6));
  EXPECT_NEAR(propagated(model, state_of(model, Quat::Identity()), t).rate_body_rad_s.z(), expected,
              1e-13);
}

TEST(PeriodicTorque, TakesPhaseInDegreesToo) {
  const AttitudeModel model = with(bench_model(), "periodic_torque",
                                   "torque_N_m = [1, 0, 0], frequency_Hz = 1, phase_deg = 90");
  EXPECT_NEAR(torque_body_N_m(model, Quat::Identity()).x(), 1.0, 1e-15);
}

// The bench with an appendage.
AttitudeModel flexible(const std::vector<double>& axis, double frequency_Hz, double damping,
                       double inertia_kg_m2, const std::string& further_keys = "") {
  return with(bench_model(), "flexible_mode",
              "axis = " + toml(axis) + ", frequency_Hz = " + toml(frequency_Hz) + ", damping = " +
                  toml(damping) + ", inertia_kg_m2 = " + toml(inertia_kg_m2) + further_keys);
}

// Two inertias coupled by a spring, without other torques: ω = ω_n √(I/(I − J)).
TEST(FlexibleMode, FreeBodySwingsAtTheCoupledFrequency) {
  const double I = 0.19, appendage = 0.05, f = 0.4;
  const AttitudeModel model = flexible({0, 0, 2}, f, 0, appendage);
  PlatformState start = state_of(model, Quat::Identity());
  start.extra[0] = 0.01;  // released with a deflected appendage
  const double coupled = 2 * pi * f * std::sqrt(I / (I - appendage));
  const PlatformState half = propagated(model, start, pi / coupled);
  EXPECT_NEAR(half.extra[0], -0.01, 1e-10);
  // The momentum stays zero, so the body rotates by 2 · 0.01 J/I in the opposite direction.
  EXPECT_NEAR(2 * std::asin(half.lab_from_body.z()), 2 * 0.01 * appendage / I, 1e-10);
}

// φ = φ₀ cos ωt + φ'₀/ω sin ωt with ω as above, on a body that rotates at the start.
TEST(FlexibleMode, StartsAsItsKeysState) {
  const double I = 0.19, appendage = 0.05, f = 0.4, rate = 0.02;
  const AttitudeModel model =
      flexible({0, 0, 1}, f, 0, appendage,
               ", initial_angle_deg = 0.5, initial_rate_rad_s = " + toml(0.3 + rate));
  const double coupled = 2 * pi * f * std::sqrt(I / (I - appendage)), t = 1.7;
  const PlatformState end = propagated(model, state_of(model, Quat::Identity(), {0, 0, 0.3}), t);
  EXPECT_NEAR(end.extra[0],
              0.5 * degree_rad * std::cos(coupled * t) + rate / coupled * std::sin(coupled * t),
              1e-10);
}

TEST(FlexibleMode, KeepsAngularMomentumAndLosesEnergyToItsDamper) {
  const AttitudeModel model = flexible({1, 1, 0}, 0.5, 0.05, 0.03);
  const Vec3 axis = Vec3(1, 1, 0).normalized();
  const Mat3 I = model.platform.inertia_kg_m2;
  const auto momentum_lab = [&](const PlatformState& s) -> Vec3 {
    const Vec3 body =
        I * s.rate_body_rad_s + 0.03 * (s.extra[1] - axis.dot(s.rate_body_rad_s)) * axis;
    return s.lab_from_body * body;
  };
  const auto energy = [&](const PlatformState& s) {
    const double along = axis.dot(s.rate_body_rad_s), angular_frequency = 2 * pi * 0.5;
    return 0.5 * s.rate_body_rad_s.dot(I * s.rate_body_rad_s) +
           0.5 * 0.03 * (s.extra[1] * s.extra[1] - along * along) +
           0.5 * 0.03 * angular_frequency * angular_frequency * s.extra[0] * s.extra[0];
  };
  const PlatformState start = state_of(model, Quat::Identity(), {0.3, -0.1, 0.2});
  EXPECT_NEAR(start.extra[1], axis.dot(Vec3(0.3, -0.1, 0.2)), 1e-16);  // at rest, no deflection
  const PlatformState middle = propagated(model, start, 20), end = propagated(model, start, 40);
  EXPECT_LT((momentum_lab(end) - momentum_lab(start)).norm(), 1e-11);
  EXPECT_LT(energy(middle), energy(start));
  EXPECT_LT(energy(end), energy(middle));
}

// The equations follow from L = ½ ωᵀ(I + φ J S) ω + J φ' a·ω + ½ J φ'² − ½ J ω_n² φ², whose energy
// and momentum are constant for any S.
TEST(FlexibleMode, KeepsMomentumAndEnergyWhereItChangesTheInertia) {
  const double J = 0.03, f = 0.5;
  const std::vector<double> slope{0.4, -0.3, -0.1, 0.5, -0.2, 0.6};
  const AttitudeModel model =
      flexible({1, 1, 0}, f, 0, J, ", inertia_slope = " + toml(slope) + ", initial_angle_deg = 6");
  const Vec3 axis = Vec3(1, 1, 0).normalized();
  Mat3 S;
  S << 0.4, 0.5, -0.2, 0.5, -0.3, 0.6, -0.2, 0.6, -0.1;
  const auto rate_of = [&](const PlatformState& s) {
    return s.extra[1] - axis.dot(s.rate_body_rad_s);
  };
  const auto inertia_at = [&](const PlatformState& s) -> Mat3 {
    return model.platform.inertia_kg_m2 + s.extra[0] * J * S;
  };
  const auto momentum_lab = [&](const PlatformState& s) -> Vec3 {
    return s.lab_from_body * Vec3(inertia_at(s) * s.rate_body_rad_s + J * rate_of(s) * axis);
  };
  const auto energy = [&](const PlatformState& s) {
    const Vec3& w = s.rate_body_rad_s;
    return 0.5 * w.dot(inertia_at(s) * w) + J * rate_of(s) * axis.dot(w) +
           0.5 * J * (std::pow(rate_of(s), 2) + std::pow(2 * pi * f * s.extra[0], 2));
  };
  const PlatformState start = state_of(model, Quat::Identity(), {0.9, -0.4, 0.7});
  const PlatformState end = propagated(model, start, 20);
  EXPECT_GT(std::abs(end.extra[0] - start.extra[0]), 1e-2);
  EXPECT_LT((momentum_lab(end) - momentum_lab(start)).norm(), 1e-9);
  EXPECT_NEAR(energy(end), energy(start), 1e-9);
}

// The state is constant, so only the derivatives limit the steps to a fraction of a swing.
TEST(FlexibleMode, OfAnAppendageAtRestTheDerivativeIsTheSwing) {
  const double I = 0.19, appendage = 0.05, f = 1.3;
  const AttitudeModel model = flexible({0, 0, 1}, f, 0, appendage);
  const double period_s = std::sqrt((I - appendage) / I) / f;
  const double times_s[] = {40.5 * period_s};
  const Dynamics dynamics(model);
  const Trajectory propagated = propagate(dynamics, state_of(model, Quat::Identity()), times_s, {},
                                          {Variable::initial_extra(0)});
  EXPECT_NEAR(propagated.derivatives[7], -1.0, 1e-6);
  EXPECT_NEAR(propagated.derivatives[2], 2 * appendage / I, 1e-6);
}

// The appendage starts at rest relative to the body for any axis. Derivatives by the axis, compared
// with differences of runs.
TEST(FlexibleMode, BeginsWithTheBodyWhenItsAxisChanges) {
  const Vec3 rate(0.3, -0.1, 0.2);
  const double times_s[] = {7.3};
  const auto end_about = [&](const Vec3& axis, const std::vector<Variable>& variables) {
    const AttitudeModel model = flexible({axis.x(), axis.y(), axis.z()}, 0.5, 0.05, 0.03);
    const PropagationOptions fine{.tolerance = 1e-12};
    const Dynamics dynamics(model);
    return propagate(dynamics, state_of(model, Quat::Identity(), rate), times_s, fine, variables);
  };
  const Vec3 axis(1.0, 2.0, -0.5);
  const size_t index = 0;
  for (int k = 0; k < 3; ++k) {
    const Trajectory motion = end_about(axis, {Variable::of(index, k)});
    const double step = 1e-4;
    const auto moved = [&](double by) {
      return end_about(axis + by * Vec3::Unit(k), {}).states.back();
    };
    const PlatformState above = moved(step), below = moved(-step);
    for (int c = 0; c < 3; ++c) {
      const double difference =
          (above.rate_body_rad_s[c] - below.rate_body_rad_s[c]) / (2.0 * step);
      EXPECT_NEAR(motion.derivatives[static_cast<size_t>(3 + c)], difference, 1e-8) << k << c;
    }
  }
}

TEST(FlexibleMode, RefusesMoreInertiaThanThePlatformHas) {
  EXPECT_THROW(flexible({0, 0, 1}, 1, 0, 0.2), InputError);
}

TEST(ActuatorGain, AddsItsShareOfTheCommand) {
  AttitudeModel common = bench_model();
  common.schedule.append(0.0, {.command_body_N_m = {1e-3, 2e-3, -3e-3}});
  const AttitudeModel per_axis = with(common, "actuator_gain", "gain_error = [0.1, -0.2, 0]");
  common = with(common, "actuator_gain", "gain_error = 0.2");
  EXPECT_LT((torque_body_N_m(common, Quat::Identity()) - Vec3(2e-4, 4e-4, -6e-4)).norm(), 1e-18);
  EXPECT_LT((torque_body_N_m(per_axis, Quat::Identity()) - Vec3(1e-4, -4e-4, 0)).norm(), 1e-18);
}

TEST(TurbineTorque, SpinsUpAboutTheVerticalAtAnyTilt) {
  const AttitudeModel model = with(bench_model(), "turbine_torque", "torque_N_m = 3e-6");
  for (const Quat& q : {Quat::Identity(), turned(0.5, {1, 2, 0})}) {
    EXPECT_LT((q * torque_body_N_m(model, q) - Vec3(0, 0, 3e-6)).norm(), 1e-20);
  }
}

TEST(RoomDraft, IsConstantInTheLab) {
  const AttitudeModel model =
      with(bench_model(), "room_draft", "torque_lab_N_m = [1e-6, -2e-6, 3e-6]");
  const Quat q = turned(1.3, {1, 2, 5});
  EXPECT_LT((q * torque_body_N_m(model, q) - Vec3(1e-6, -2e-6, 3e-6)).norm(), 1e-20);
}

}  // namespace
}  // namespace photorque
