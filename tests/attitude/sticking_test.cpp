// Friction that stops and holds a platform, and a cable that winds up: laws with layers far thinner
// than a step, compared with the closed forms of one degree of freedom (textbook mechanics, e.g. J.
// P. den Hartog, "Mechanical Vibrations", for friction and spring).
#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

constexpr double I_kg_m2 = 0.19;  // of the bench platform about z

// Yaw of a rotation about z, between −π and π.
double yaw_rad(const Quat& q) {
  const double angle = 2.0 * std::atan2(q.z(), q.w());
  return std::remainder(angle, 2.0 * pi);
}

// A constant torque that is weaker than the friction: the platform decelerates uniformly, stops,
// and creeps at the rate at which the friction law balances the torque.
struct Held {
  double torque_N_m = 4e-6, friction_N_m = 1e-5, start_rad_s = 0.02, creep_rad_s = 1e-6;

  double stops_s() const { return start_rad_s * I_kg_m2 / (friction_N_m - torque_N_m); }
  double creeps_rad_s() const {
    return creep_rad_s * torque_N_m /
           std::sqrt(friction_N_m * friction_N_m - torque_N_m * torque_N_m);
  }
  double angle_rad(double time_s) const {
    return 0.5 * start_rad_s * stops_s() + creeps_rad_s() * (time_s - stops_s());
  }
  AttitudeModel model() const {
    return with(with(bench_model(), "turbine_torque", "torque_N_m = " + toml(torque_N_m)),
                "dry_friction",
                "torque_N_m = " + toml(friction_N_m) + ", creep_rate_rad_s = " + toml(creep_rad_s));
  }
};

TEST(Sticking, IsCrossedInFewSteps) {
  const Held held;
  const AttitudeModel model = held.model();
  const Dynamics dynamics(model);
  const double times_s[] = {1e5};
  const Trajectory t =
      propagate(dynamics, state_of(model, Quat::Identity(), {0, 0, held.start_rad_s}), times_s);
  // The smooth layer of the law changes the stopping time by a fraction of about creep/rate, some
  // 1e-4 rad.
  EXPECT_NEAR(std::remainder(yaw_rad(t.states[0].lab_from_body) - held.angle_rad(1e5), 2 * pi), 0.0,
              1e-5);
  EXPECT_NEAR(t.states[0].rate_body_rad_s.z(), held.creeps_rad_s(), 1e-12);
  // While it sticks, fixed-point iteration would need steps of a few times I · creep/friction =
  // 0.02 s, a million in all.
  EXPECT_LT(t.statistics.steps, 500);
  EXPECT_GT(t.statistics.stiff, 0);
}

// ∂angle/∂friction compared with the closed form and, to more digits, with differences of the
// trajectory.
TEST(Sticking, HasExactDerivatives) {
  const Held held;
  const AttitudeModel model = held.model();
  const double times_s[] = {2000.0};
  PropagationOptions options;
  options.tolerance = 1e-11;
  const auto angle = [&](double by_N_m) {
    AttitudeModel changed = model;
    changed.disturbances.back().parameters[0].value += by_N_m;
    const Dynamics dynamics(changed);
    return yaw_rad(propagate(dynamics,
                             state_of(changed, Quat::Identity(), {0, 0, held.start_rad_s}), times_s,
                             options)
                       .states[0]
                       .lab_from_body);
  };
  const Dynamics dynamics(model);
  const Trajectory t =
      propagate(dynamics, state_of(model, Quat::Identity(), {0, 0, held.start_rad_s}), times_s,
                options, {Variable::of(1, 0)});
  const double step_N_m = 1e-9;
  const double difference = (angle(step_N_m) - angle(-step_N_m)) / (2.0 * step_N_m);
  EXPECT_NEAR(t.derivatives[2] / difference, 1.0, 1e-5);
  // θ = ½ I ω²/(τ − T) + …, where the creep contributes a hundredth of a per cent.
  const double closed_form =
      -0.5 * held.start_rad_s * held.stops_s() / (held.friction_N_m - held.torque_N_m);
  EXPECT_NEAR(t.derivatives[2] / closed_form, 1.0, 2e-3);
}

// A wheel at rest whose angle is not used has only derivatives that decay: ω = ω₀ − (τ/I) t until
// it stops, so ∂ω/∂τ = −t/I before the stop and 0 afterwards.
TEST(Sticking, DerivativesThatDiedAwayCostNoSteps) {
  constexpr double friction_N_m = 1e-3, start_rad_s = 1.0;
  AttitudeModel model = with(bench_model(), "dry_friction", "torque_N_m = " + toml(friction_N_m));
  model.holds_attitude = true;
  const double stops_s = start_rad_s * I_kg_m2 / friction_N_m;
  const double times_s[] = {0.5 * stops_s, 5.0 * stops_s};
  const Dynamics dynamics(model);
  const Trajectory t = propagate(dynamics, state_of(model, Quat::Identity(), {0, 0, start_rad_s}),
                                 times_s, {}, {Variable::of(0, 0)});
  constexpr size_t rate_z = 5;
  EXPECT_NEAR(t.derivatives[rate_z] / (-0.5 * stops_s / I_kg_m2), 1.0, 1e-6);
  EXPECT_NEAR(t.derivatives[t.components + rate_z] / (stops_s / I_kg_m2), 0.0, 1e-9);
  EXPECT_LT(t.statistics.steps, 2000);
}

// With a spring and friction the amplitude decreases by 2 τ/k in each half swing. The friction
// changes its sign within nanoseconds, anywhere within a step: 40 half swings, at the default
// tolerance.
TEST(Sticking, EveryReversalIsSeen) {
  constexpr double k = 2e-4, friction_N_m = 1e-6;
  const AttitudeModel model =
      with(with(bench_model(), "tether", "stiffness_N_m_per_rad = " + toml(k)), "dry_friction",
           "torque_N_m = " + toml(friction_N_m) + ", creep_rate_rad_s = 1e-10");
  const Dynamics dynamics(model);
  const double half_period_s = pi * std::sqrt(I_kg_m2 / k);
  for (int start = 0; start < 10; ++start) {
    const double amplitude_rad = 0.6 + 0.037 * start;
    std::vector<double> times_s;
    for (int half = 1; half <= 40; ++half) times_s.push_back(half * half_period_s);
    const Trajectory t =
        propagate(dynamics, state_of(model, turned(amplitude_rad, {0, 0, 1})), times_s);
    for (int half = 1; half <= 40; ++half) {
      const double left_rad = amplitude_rad - 2 * half * friction_N_m / k;
      const double at_rad = yaw_rad(t.states[static_cast<size_t>(half - 1)].lab_from_body);
      EXPECT_NEAR(at_rad, half % 2 == 1 ? -left_rad : left_rad, 3e-7) << start << " " << half;
    }
  }
}

// About one axis the friction is exactly Coulomb's. With the same spring, the amplitude decreases
// by 2 τ/k in each half swing until an end is within τ/k, where the platform stays.
struct OneAxis {
  double k = 2e-4, friction_N_m = 1e-5, start_rad = 0.53;

  AttitudeModel model() const {
    AttitudeModel model = bench_model();
    model.platform.topology = Topology::one_axis;
    return with(with(std::move(model), "tether", "stiffness_N_m_per_rad = " + toml(k)),
                "dry_friction", "torque_N_m = " + toml(friction_N_m));
  }
  double half_period_s() const { return pi * std::sqrt(I_kg_m2 / k); }
  // A half swing is a cosine about the centre ±τ/k.
  double angle_rad(double time_s) const {
    double end_rad = start_rad;
    for (double from_s = 0.0;; from_s += half_period_s()) {
      if (std::abs(end_rad) <= friction_N_m / k) return end_rad;
      const double centre_rad = std::copysign(friction_N_m / k, end_rad);
      if (time_s <= from_s + half_period_s()) {
        return centre_rad +
               (end_rad - centre_rad) * std::cos(pi * (time_s - from_s) / half_period_s());
      }
      end_rad = 2.0 * centre_rad - end_rad;
    }
  }
  Trajectory at(std::span<const double> times_s,
                const std::vector<Variable>& variables = {}) const {
    const AttitudeModel all = model();
    const Dynamics dynamics(all);
    return propagate(dynamics, state_of(all, turned(start_rad, {0, 0, 1})), times_s, {}, variables);
  }
};

// A trial of a fit may have a friction that drives. Its rate may hardly change at the end of a
// slip, and Newton's method then finds no zero nearby: the propagation must end all the same.
TEST(Sticking, EndsWhereTheRateHardlyChangesAtItsZero) {
  AttitudeModel model;
  model.platform.topology = Topology::one_axis;
  model.platform.axis = Vec3::UnitX();
  model.platform.mass_kg = 1.0;
  model.platform.inertia_kg_m2 = Mat3::Identity();
  model = with(model, "static_unbalance", "offset_m = [0, -0.900448, -3.0716416]");
  const auto add = [&](const std::string& kind, const std::string& key, double value) {
    model = with(model, kind, key + " = 0");
    model.disturbances.back().parameters[0].value = value;
  };
  add("bearing_drag", "coefficient_N_m_s", 238.43128548652123);
  add("dry_friction", "torque_N_m", -40.660917537255678);
  add("air_friction", "coefficient", -232.46535626843632);
  add("air_pressure_drag", "coefficient_N_m_s2", 58.354484251557658);
  model = with(model, "room_draft", "torque_lab_N_m = [9.5366790563112289, 0, 0]");
  const Dynamics dynamics(model);
  const double times_s[] = {24.491};
  const Trajectory t = propagate(dynamics,
                                 state_of(model, {0.96311491782356884, -0.2690904217279026, 0, 0},
                                          {-30.23814623511905, 0, 0}, 23.39),
                                 times_s);
  EXPECT_LT(t.statistics.rejected, 1000);
}

// The platform rests after five half swings.
TEST(Sticking, AboutOneAxisLosesFourTimesFrictionOverStiffnessACycle) {
  const OneAxis swing;
  std::vector<double> times_s;
  for (double part = 0.31; part < 9.0; part += 0.37)
    times_s.push_back(part * swing.half_period_s());
  const Trajectory t = swing.at(times_s);
  for (size_t i = 0; i < times_s.size(); ++i) {
    EXPECT_NEAR(yaw_rad(t.states[i].lab_from_body), swing.angle_rad(times_s[i]), 1e-8) << i;
  }
  EXPECT_EQ(t.states.back().rate_body_rad_s.z(), 0.0);
  EXPECT_LT(t.statistics.steps, 200);
}

// Derivatives by friction and stiffness, before and after every reversal and at rest, compared with
// differences of the closed form.
TEST(Sticking, AboutOneAxisDerivativesCrossReversals) {
  const OneAxis swing;
  std::vector<double> times_s;
  for (double part = 0.31; part < 9.0; part += 0.37)
    times_s.push_back(part * swing.half_period_s());
  const Trajectory t = swing.at(times_s, {Variable::of(1, 0), Variable::of(0, 0)});
  const auto difference = [&](double OneAxis::*which, double relative, double time_s) {
    OneAxis more = swing, less = swing;
    more.*which *= 1.0 + relative;
    less.*which *= 1.0 - relative;
    return (more.angle_rad(time_s) - less.angle_rad(time_s)) / (2.0 * relative * swing.*which);
  };
  const double by_friction_scale = 1.0 / swing.k, by_stiffness_scale = swing.start_rad / swing.k;
  for (size_t i = 0; i < times_s.size(); ++i) {
    const size_t angle = (i * t.components + 2) * 2;
    EXPECT_NEAR(t.derivatives[angle] / by_friction_scale,
                difference(&OneAxis::friction_N_m, 1e-5, times_s[i]) / by_friction_scale, 1e-5)
        << i;
    EXPECT_NEAR(t.derivatives[angle + 1] / by_stiffness_scale,
                difference(&OneAxis::k, 1e-5, times_s[i]) / by_stiffness_scale, 1e-5)
        << i;
  }
}

// The torque of a cable that winds up increases with every turn: an oscillator with an amplitude of
// three turns.
TEST(Tether, CountsItsTurns) {
  constexpr double k = 2e-4, amplitude_rad = 6 * pi;
  const double omega_1_s = std::sqrt(k / I_kg_m2);
  const AttitudeModel model =
      with(bench_model(), "tether", "stiffness_N_m_per_rad = " + toml(k) + ", winds_up = true");
  const PlatformState start = state_of(model, Quat::Identity(), {0, 0, amplitude_rad * omega_1_s});
  for (const double time_s : {10.0, 40.0, 100.0, 300.0}) {
    const PlatformState end = propagated(model, start, time_s);
    EXPECT_NEAR(end.rate_body_rad_s.z(), amplitude_rad * omega_1_s * std::cos(omega_1_s * time_s),
                1e-9);
    const double off_rad =
        yaw_rad(end.lab_from_body) - amplitude_rad * std::sin(omega_1_s * time_s);
    EXPECT_NEAR(std::remainder(off_rad, 2 * pi), 0.0, 1e-8);
  }
}

}  // namespace
}  // namespace photorque
