#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "attitude/environment/sun.h"
#include "attitude/model/platform.h"
#include "attitude/propagation/propagator.h"
#include "core/errors.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

AttitudeModel commanded(double inertia_kg_m2, const Vec3& torque_N_m, double current_A = 0.0) {
  AttitudeModel model;
  model.platform.inertia_kg_m2 = inertia_kg_m2 * Mat3::Identity();
  model.schedule.append(0.0, {.command_body_N_m = torque_N_m, .battery_current_A = current_A});
  return model;
}

Trajectory propagate_model(const AttitudeModel& model, double end_s,
                           const std::vector<EventFunction>& events) {
  const Dynamics dynamics(model);
  std::vector<double> times_s;
  for (int i = 0; i <= 100; ++i) times_s.push_back(end_s * i / 100);
  return propagate(dynamics, dynamics.initial_state(), times_s, {}, {}, events);
}

// From rest under a constant torque τ the tilt is ½ τ t²/I.
TEST(TiltStop, IsReachedAtTheTimeOfTheParabolaAndEndsTheRun) {
  const double tilt_rad = 0.5, inertia = 0.12, torque = 3e-5;
  const double expected_s = std::sqrt(2 * tilt_rad * inertia / torque);
  const Trajectory t =
      propagate_model(commanded(inertia, {torque, 0, 0}), 2 * expected_s, {tilt_event(tilt_rad)});
  ASSERT_EQ(t.events.size(), 1u);
  EXPECT_EQ(t.events[0].name, "tilt_stop");
  EXPECT_NEAR(t.events[0].time_s, expected_s, 1e-9);
  // The 51st output time equals the time of the stop up to rounding, so there are 50 or 51 states.
  EXPECT_LE(t.states.back().time_s, t.events[0].time_s);
  EXPECT_GE(t.states.size(), 50u);
}

TEST(BatteryEmpty, IsWhenTheChargeIsGone) {
  const Trajectory t =
      propagate_model(commanded(1.0, Vec3::Zero(), 2.5), 2000.0, {battery_empty_event(3600.0)});
  ASSERT_EQ(t.events.size(), 1u);
  EXPECT_NEAR(t.events[0].time_s, 3600.0 / 2.5, 1e-9);
}

TEST(Events, ThatDoNotEndTheRunAreAllFound) {
  AttitudeModel model = commanded(1.0, Vec3::Zero());
  const Dynamics dynamics(model);
  PlatformState state = dynamics.initial_state({0, 0, 0.1});
  // Body x rotates in the horizontal plane: its y component is sin(0.1 t).
  const EventFunction crossing{"crossing", false, false, [](const Lanes&, const Lanes* y) {
                                 return 2.0 * (y[1] * y[2] + y[0] * y[3]) - 0.3;
                               }};
  const Trajectory t = propagate(dynamics, state, std::vector<double>{1000.0}, {}, {}, {crossing});
  std::vector<double> expected_s;
  for (int k = 0; k < 16; ++k) {
    expected_s.push_back((std::asin(0.3) + 2 * pi * k) / 0.1);
    expected_s.push_back((pi - std::asin(0.3) + 2 * pi * k) / 0.1);
  }
  while (expected_s.back() > 1000.0) expected_s.pop_back();
  ASSERT_EQ(t.events.size(), expected_s.size());
  for (size_t i = 0; i < expected_s.size(); ++i) {
    EXPECT_NEAR(t.events[i].time_s, expected_s[i], 1e-7);
    EXPECT_EQ(t.events[i].rising, i % 2 == 0);
  }
}

// Torques that jump at times without an exact binary representation: the rate is the integral of
// the torque divided by the inertia.
TEST(Commands, AreHitExactly) {
  AttitudeModel model = commanded(0.1, Vec3::Zero());
  double rate = 0.0, angle = 0.0, t = 0.0;
  for (int i = 1; i <= 200; ++i) {
    const double torque = (i % 7 - 3) * 1e-4, next = 0.1 * i + 0.003 * (i % 5);
    model.schedule.append(t + 1e-300, {.command_body_N_m = {0, 0, torque}});
    angle += rate * (next - t) + 0.5 * torque / 0.1 * (next - t) * (next - t);
    rate += torque / 0.1 * (next - t);
    t = next;
  }
  const Dynamics dynamics(model);
  const PlatformState end =
      propagate(dynamics, dynamics.initial_state(), std::vector<double>{t}).states.back();
  EXPECT_NEAR(end.rate_body_rad_s.z(), rate, 1e-14);
  EXPECT_NEAR(yaw_rad(end), angle, 1e-13);
}

TEST(Propagation, IsTheSameToTheBitWhateverIsAskedOfIt) {
  AttitudeModel model = with(bench_model(), "static_unbalance", "offset_m = [1e-5, 0, -1e-4]");
  model = with(model, "air_friction", "coefficient = 1e-4");
  const Dynamics dynamics(model);
  const PlatformState start = state_of(model, turned(0.3, {1, 2, 0}), {0.02, 0.01, 0.1});
  std::vector<double> sparse = {50.0, 300.0}, fine;
  for (int i = 0; i <= 3000; ++i) fine.push_back(0.1 * i);
  const Trajectory a = propagate(dynamics, start, sparse), b = propagate(dynamics, start, fine);
  EXPECT_EQ(to_vector(a.states[0]), to_vector(b.states[500]));
  EXPECT_EQ(to_vector(a.states[1]), to_vector(b.states[3000]));
  const Trajectory c = propagate(dynamics, start, sparse, {}, {Variable::of(0, 2)});
  EXPECT_EQ(to_vector(a.states[1]), to_vector(c.states[1]));
}

TEST(Propagation, FallsByTheToleranceAsked) {
  AttitudeModel model = with(bench_model(), "static_unbalance", "offset_m = [1e-5, 0, -3e-4]");
  const PlatformState start = state_of(model, turned(0.5, {1, 2, 0}), {0.02, 0.01, 0.1});
  const PlatformState best = propagated(model, start, 600.0, 1e-13);
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const PlatformState end = propagated(model, start, 600.0, tolerance);
    EXPECT_LT(end.lab_from_body.angularDistance(best.lab_from_body), 10 * tolerance);
  }
}

struct GrowingRate final : TorqueLaw<GrowingRate> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>&, const EvaluationContext<T>& now) const {
    return length(now.rate_body_rad_s) * now.rate_body_rad_s;
  }
};

// 10 s at 1e9 rad/s would need far too many steps.
TEST(Propagation, ReportsEarlyThatAMotionIsTooFastForItsDuration) {
  const Dynamics dynamics(commanded(1.0, Vec3::Zero()));
  const PlatformState spinning = dynamics.initial_state({1e9, 3e8, 0.0});
  EXPECT_THROW(propagate(dynamics, spinning, std::vector<double>{10.0}), NumericalError);
}

// ω' = ω² becomes infinite at t = 1/ω₀.
TEST(Propagation, ReportsTheEndOfTheSolution) {
  AttitudeModel model = commanded(1.0, Vec3::Zero());
  model.disturbances = {make_disturbance<GrowingRate>({})};
  const Dynamics dynamics(model);
  const PlatformState start = dynamics.initial_state({0, 0, 0.1});
  const PlatformState before = propagate(dynamics, start, std::vector<double>{9.0}).states.back();
  EXPECT_NEAR(before.rate_body_rad_s.z(), 1.0, 1e-9);
  EXPECT_THROW(propagate(dynamics, start, std::vector<double>{11.0}), NumericalError);
}

TEST(Propagation, RefusesStatesThatAreNone) {
  const Dynamics dynamics(bench_model());
  PlatformState state = dynamics.initial_state();
  state.lab_from_body.coeffs() *= 1.1;
  EXPECT_THROW(propagate(dynamics, state, std::vector<double>{1.0}), InputError);
  state = dynamics.initial_state();
  state.extra = {0.0};
  EXPECT_THROW(propagate(dynamics, state, std::vector<double>{1.0}), InputError);
}

// Fractions of a disc: two unit discs whose centres are one radius apart share 2π/3 − √3/2.
TEST(Eclipse, UncoveredShareMatchesClosedForms) {
  EXPECT_EQ(uncovered_fraction(1.0, 2.0, 3.0), 1.0);
  EXPECT_EQ(uncovered_fraction(1.0, 2.0, 0.9), 0.0);
  EXPECT_DOUBLE_EQ(uncovered_fraction(2.0, 1.0, 0.5), 0.75);
  EXPECT_NEAR(uncovered_fraction(1.0, 1.0, 1.0), 1.0 - (2 * pi / 3 - std::sqrt(3.0) / 2) / pi,
              1e-14);
  EXPECT_NEAR(uncovered_fraction(1e-9, 1.0, 1.0), 0.5, 1e-9);
}

// Tudat's case of a partial eclipse, computed exactly (shared reference attitude.md, section 4),
// and its annular eclipse with flat discs.
TEST(Eclipse, SunlitFractionMatchesTheReferenceCases) {
  const Vec3 satellite_m = (6378.137e3 + 1e3) * Vec3(0.018, 1, 0).normalized();
  EXPECT_NEAR(sunlit_fraction(satellite_m, {-149598000e3, 0, 0}, 6378.137e3, 6.96e8),
              0.454664774714140599, 1e-9);
  EXPECT_NEAR(sunlit_fraction({2, 0, 0}, {-1, 0, 0}, 1.0, 2.0), 0.485156027651699, 1e-12);
}

// With the Sun in the plane of a circular orbit, the shadow covers an angle of 2 asin(R/r), centred
// opposite to the Sun. The events are at half light, when the Sun's centre is on the horizon.
TEST(Eclipse, LastsAsLongAsTheShadowIsWide) {
  AttitudeModel model = commanded(1.0, Vec3::Zero());
  model =
      with(model, "orbit", "altitude_m = 500e3, inclination_deg = 0.0, sun_direction = [1, 0, 0]");
  const Dynamics dynamics(model);
  const double radius_m = 6871.2e3, motion = std::sqrt(3.986004418e14 / std::pow(radius_m, 3));
  const double period_s = 2 * pi / motion, half_shadow_s = std::asin(6371.2 / 6871.2) / motion;
  const Trajectory t = propagate(dynamics, dynamics.initial_state(), std::vector<double>{period_s},
                                 {}, {}, {eclipse_event(dynamics)});
  ASSERT_EQ(t.events.size(), 2u);
  EXPECT_EQ(t.events[0].name, "eclipse_begins");
  EXPECT_EQ(t.events[1].name, "eclipse_ends");
  EXPECT_NEAR(t.events[0].time_s, period_s / 2 - half_shadow_s, 0.1);
  EXPECT_NEAR(t.events[1].time_s, period_s / 2 + half_shadow_s, 0.1);
}

}  // namespace
}  // namespace photorque
