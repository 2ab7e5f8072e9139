// The simulator of `prove` against the propagator of folder attitude: two implementations of the
// same catalogue that share nothing but the formulas. A slip in either shows here.
#include <gtest/gtest.h>

#include <cmath>

#include "attitude/disturbances/kind.h"
#include "attitude/propagation/run.h"
#include "tools/proof/motion.h"

namespace photorque {
namespace {

using Values = std::vector<std::pair<std::string, std::vector<double>>>;

struct KindCase {
  std::string kind;
  Values values;
};

// Strong enough to turn the platform far from where it would be otherwise.
std::vector<KindCase> kind_cases() {
  return {
      {"static_unbalance", {{"offset_m", {2e-6, -3e-6, 4e-6}}}},
      {"mass_shift", {{"time_s", {31.4}}, {"offset_m", {2e-6, -3e-6, 4e-6}}}},
      {"battery_discharge", {{"shift_m_per_Ah", {3e-5, 2e-5, -1e-5}}}},
      {"elastic_sag", {{"compliance_s2", {1e-6, 2e-6, 3e-7}}}},
      {"bearing_drag", {{"coefficient_N_m_s", {2e-4}}}},
      {"turbine_torque", {{"torque_N_m", {2e-5}}}},
      {"dry_friction", {{"torque_N_m", {5e-6}}}},
      {"air_friction", {{"coefficient", {3e-4}}}},
      {"air_pressure_drag", {{"coefficient_N_m_s2", {3e-3}}}},
      {"room_draft", {{"torque_lab_N_m", {1e-5, -2e-5, 3e-6}}}},
      {"magnetic_dipole", {{"dipole_A_m2", {0.3, -0.2, 0.1}}}},
      {"eddy_damping", {{"coefficient_N_m_s_per_T2", {5e4}}}},
      {"gravity_gradient", {}},
      {"earth_rotation", {}},
      {"rotor_momentum", {{"momentum_N_m_s", {2e-3, -4e-3, 3e-3}}}},
      {"tether", {{"stiffness_N_m_per_rad", {1e-3}}}},
      {"floor_vibration",
       {{"acceleration_m_s2", {0.05, 0.02, -0.04}}, {"frequency_Hz", {0.7}}, {"phase", {0.4}}}},
      {"periodic_torque",
       {{"torque_N_m", {3e-5, -5e-5, 2e-5}}, {"frequency_Hz", {0.6}}, {"phase", {-1.1}}}},
      {"flexible_mode",
       {{"axis", {0.4, -0.3, 0.8}},
        {"frequency_Hz", {0.4}},
        {"damping", {0.03}},
        {"inertia_kg_m2", {0.02}}}},
      {"actuator_gain", {{"gain_error", {0.3}}}},
      {"inertia_error", {{"delta_kg_m2", {2e-3, -3e-3, 4e-3, 1e-3, -2e-3, 5e-4}}}},
      {"gravity_tilt", {{"tilt_rad", {3e-3, -5e-3}}}},
      {"attitude_latency", {{"latency_s", {0.13}}}},
      {"gyro_bias", {{"bias_rad_s", {1e-3, -2e-3, 3e-3}}}},
      {"gyro_scale", {{"scale", {0.01, -0.02, 0.03}}}},
      {"gyro_misalignment", {{"misalignment_rad", {0.01, -0.02, 0.03}}}},
      {"camera_misalignment", {{"misalignment_rad", {0.01, -0.02, 0.03}}}},
  };
}

constexpr double duration_s = 60.0, rate_Hz = 5.0;

InjectedWorld world_of(const KindCase& c) {
  InjectedWorld world;
  world.mass_kg = 7.5;
  world.inertia_kg_m2 = {{{0.11, 0, 0}, {0, 0.125, 0}, {0, 0, 0.19}}};
  world.magnetic_field_T = {1e-6, 2.2e-5, -4.1e-5};
  world.latitude_rad = 0.8;
  world.offset_m = {1e-6, -2e-6, -4e-5};
  world.drag_N_m_s = 1.3e-5;
  InjectedEffect effect{c.kind, {}};
  for (const auto& [key, numbers] : c.values) effect.parameters[key] = numbers;
  world.effects = {effect};
  return world;
}

InjectedStart start() {
  InjectedStart s;
  s.attitude = injected::quaternion_of({0.08, -0.05, 0.3});
  s.rate_rad_s = {0.013, -0.02, 0.021};
  return s;
}

std::vector<InjectedCommand> commands() {
  return {{0.0, {}, 3.0},
          {10.0, {3e-4, -2e-4, 1e-4}, 3.0},
          {16.0, {}, 6.0},
          {40.0, {-1e-4, 4e-4, 2e-4}, 6.0},
          {44.0, {}, 2.0}};
}

// The same in folder attitude.
PropagationRun run_of(const KindCase& c) {
  const InjectedWorld world = world_of(c);
  PropagationRun run;
  Platform& platform = run.model.platform;
  platform.mass_kg = world.mass_kg;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<size_t>(i);
    platform.inertia_kg_m2(i, i) = world.inertia_kg_m2[k][k];
    run.model.environment.magnetic_field_lab_T[i] = world.magnetic_field_T[k];
    run.initial.rate_body_rad_s[i] = start().rate_rad_s[k];
  }
  Environment& environment = run.model.environment;
  environment.latitude_rad = world.latitude_rad;
  environment.earth_rate_lab_rad_s =
      earth_rate_rad_s * Vec3(0.0, std::cos(world.latitude_rad), std::sin(world.latitude_rad));
  const DisturbanceContext context{platform, environment};
  const auto& r = world.offset_m;
  run.model.disturbances = {
      make_disturbance_of("static_unbalance", {{"offset_m", {r[0], r[1], r[2]}}}, context),
      make_disturbance_of("bearing_drag", {{"coefficient_N_m_s", {world.drag_N_m_s}}}, context),
      make_disturbance_of(c.kind, c.values, context)};
  for (const InjectedCommand& command : commands()) {
    const auto& t = command.torque_N_m;
    run.model.schedule.append(command.time_s, {Vec3(t[0], t[1], t[2]), command.battery_current_A});
  }
  const auto& q = start().attitude;
  run.initial.lab_from_body = Quat(q[0], q[1], q[2], q[3]);
  const Vec3 rate = run.initial.rate_body_rad_s;
  for (const Disturbance& d : run.model.disturbances) {
    for (const ExtraState& s : d.states) {
      run.initial.extra.push_back(s.initial + s.per_body_rate.dot(rate));
    }
  }
  run.sensors = perfect_sensors();
  run.sensors.camera->noise_rad = Vec3::Zero();
  run.duration_s = duration_s;
  run.output_rate_Hz = rate_Hz;
  run.options.tolerance = 1e-10;
  return run;
}

class ProveSimulator : public testing::TestWithParam<KindCase> {};

TEST_P(ProveSimulator, ReadsWhatThePropagatorReads) {
  const Recording recording = propagate(run_of(GetParam())).recording;
  const InjectedWorld world = world_of(GetParam());
  std::vector<double> seen_s = recording.time_s;
  for (double& t_s : seen_s) t_s = std::max(0.0, t_s - injected_latency_s(world));
  const auto moments = injected_motion(world, commands(), start(), 0.0, recording.time_s, 0.01);
  const auto seen = injected_motion(world, commands(), start(), 0.0, seen_s, 0.01);
  ASSERT_EQ(moments.size(), static_cast<size_t>(duration_s * rate_Hz) + 1);
  const char* const rates[] = {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"};
  const char* const attitude[] = {"q_w", "q_x", "q_y", "q_z"};
  double worst_rad = 0.0, worst_rad_s = 0.0;
  for (size_t i = 0; i < moments.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      const double miss = recording.find(rates[k])->values[i] - moments[i].gyro_rad_s[k];
      worst_rad_s = std::max(worst_rad_s, std::abs(miss));
    }
    injected::Quaternion q;
    for (size_t k = 0; k < 4; ++k) q[k] = recording.find(attitude[k])->values[i];
    const auto turn = injected::product(q, injected::conjugate(seen[i].camera));
    // What a late camera sees first lies before the start, which either continues in its own way.
    if (recording.time_s[i] < injected_latency_s(world)) continue;
    worst_rad = std::max(worst_rad, injected::length(injected::turn_of(turn)));
  }
  // A thousandth of the camera's and the gyro's noise.
  EXPECT_LT(worst_rad, 6e-8);
  EXPECT_LT(worst_rad_s, 2e-8);
}

// The comparison above means something only where the effect moves the readings far beyond it.
TEST_P(ProveSimulator, EffectShows) {
  InjectedWorld without = world_of(GetParam());
  without.effects.clear();
  std::vector<double> times_s;
  for (double t = 1.0; t < duration_s; t += 1.0) times_s.push_back(t);
  std::vector<double> seen_s = times_s;
  for (double& t_s : seen_s) t_s -= injected_latency_s(world_of(GetParam()));
  const auto acting = injected_motion(world_of(GetParam()), commands(), start(), 0.0, seen_s, 0.01);
  const auto free = injected_motion(without, commands(), start(), 0.0, times_s, 0.01);
  double most = 0.0;
  for (size_t i = 0; i < times_s.size(); ++i) {
    const auto turn = injected::product(acting[i].camera, injected::conjugate(free[i].camera));
    most = std::max(most, injected::length(injected::turn_of(turn)));
    most =
        std::max(most, injected::length(injected::minus(acting[i].gyro_rad_s, free[i].gyro_rad_s)));
  }
  EXPECT_GT(most, 1e-4 * (GetParam().kind == "gravity_gradient" ? 0.01 : 1.0));
}

INSTANTIATE_TEST_SUITE_P(Kinds, ProveSimulator, testing::ValuesIn(kind_cases()),
                         [](const auto& c) { return c.param.kind; });

TEST(ProveSimulator, CoversTheCatalogue) {
  std::vector<std::string> tested;
  for (const KindCase& c : kind_cases()) tested.push_back(c.kind);
  for (const std::string& kind : injected_kinds()) {
    if (is_outside_catalogue(kind)) continue;
    EXPECT_NE(std::ranges::find(tested, kind), tested.end()) << kind;
  }
}

// Kutta's method is of fourth order: half the step, a sixteenth of the error.
TEST(ProveSimulator, ErrorFallsWithTheFourthPowerOfTheStep) {
  const InjectedWorld world = world_of(kind_cases()[17]);
  const auto end = [&](double step_s) {
    return injected_motion(world, {}, start(), 0.0, {40.0}, step_s)[0];
  };
  const auto error = [&](double step_s) {
    return injected::length(injected::minus(end(step_s).rate_rad_s, end(0.003125).rate_rad_s));
  };
  const double ratio = error(0.1) / error(0.05);
  EXPECT_GT(ratio, 12.0);
  EXPECT_LT(ratio, 20.0);
}

// A torque about the vertical that repeats three times a turn does no work over a turn.
TEST(ProveSimulator, CoggingRepeatsWithHeading) {
  InjectedWorld world = world_of({"heading_cogging", {}});
  world.offset_m = {};
  world.drag_N_m_s = 0.0;
  world.effects = {
      {"heading_cogging", {{"torque_N_m", {2e-5}}, {"periods", {3.0}}, {"phase", {0.0}}}}};
  InjectedStart level;
  level.rate_rad_s = {0, 0, 0.2};
  std::vector<double> times_s;
  for (int i = 0; i <= 4000; ++i) times_s.push_back(0.01 * i);
  const auto moments = injected_motion(world, {}, level, 0.0, times_s, 0.01);
  for (const InjectedContext& m : moments) {
    // Energy: ½ I ω² = ½ I ω₀² + T/3 (1 − cos 3ψ).
    const auto& q = m.attitude;
    const double heading = 2.0 * std::atan2(q[3], q[0]);
    const double work = 2e-5 / 3.0 * (1.0 - std::cos(3.0 * heading));
    EXPECT_NEAR(0.5 * 0.19 * m.rate_rad_s[2] * m.rate_rad_s[2], 0.5 * 0.19 * 0.04 + work, 1e-12);
  }
}

}  // namespace
}  // namespace photorque
