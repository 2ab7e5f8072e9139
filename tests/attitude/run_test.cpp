#include "attitude/propagation/run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "attitude/model/platform.h"
#include "core/constants.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/files.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using testing::HasSubstr;

// An experiment like those in the contract.
const std::string experiment_text = R"([platform]
topology = "tabletop"
mass_kg = 8.7
inertia_kg_m2 = [[0.116, 0, 0], [0, 0.12, 0], [0, 0, 0.183]]
[environment]
gravity_m_s2 = 9.80665
magnetic_field_T = [1.6e-6, 2e-5, -3.7e-5]
latitude_deg = 45.5
[[disturbance]]
kind = "static_unbalance"
offset_m = { value = [-9e-7, -3e-6, -4e-5], sigma = [5e-7, 5e-7, 3e-6] }
[[disturbance]]
kind = "bearing_drag"
coefficient_N_m_s = { value = 9e-6, sigma = 2e-6 }
[sensors.camera]
noise_arcsec = [37, 37, 12]
[sensors.gyro]
noise_rad_s = 2e-4
bias_rad_s = { value = [0, 0, 0], sigma = [1e-3, 1e-3, 1e-3] }
[propagate]
duration_s = 30.0
initial_tilt_deg = 10.0
initial_rate_rad_s = [0, 0, 0.05]
)";

// The run of the experiment with changes as by --set.
PropagationRun run_with(const std::vector<std::string>& changes = {},
                        const std::string& text = experiment_text) {
  SettingsNode root = parse_toml(text, "run.toml");
  for (const std::string& change : changes) apply_override(root, change);
  return read_propagation(Settings(root));
}

std::string complaint_with(const std::vector<std::string>& changes,
                           const std::string& text = experiment_text) {
  return refusal_of([&] { run_with(changes, text); });
}

TEST(Experiment, OfTheContractIsReadWhole) {
  const PropagationRun run = run_with();
  EXPECT_EQ(run.model.platform.topology, Topology::tabletop);
  EXPECT_EQ(run.model.platform.mass_kg, 8.7);
  EXPECT_EQ(run.model.environment.gravity_lab_m_s2.z(), -9.80665);
  EXPECT_NEAR(run.model.environment.earth_rate_lab_rad_s.z(),
              7.292115e-5 * std::sin(45.5 * degree_rad), 1e-18);
  ASSERT_EQ(run.model.disturbances.size(), 3u);
  const Parameter& z = run.model.disturbances[0].parameters[2];
  EXPECT_EQ(z.key, "offset_m");
  EXPECT_EQ(z.component, 2);
  EXPECT_EQ(z.value, -4e-5);
  EXPECT_EQ(z.sigma, 3e-6);
  EXPECT_EQ(run.model.disturbances[2].kind, "gyro_bias");
  EXPECT_EQ(run.model.disturbances[2].parameters[1].sigma, 1e-3);
  EXPECT_NEAR(run.sensors.camera->noise_rad.z(), 12 * arcsecond_rad, 1e-18);
  EXPECT_NEAR(tilt_rad(run.initial), 10 * degree_rad, 1e-15);
}

TEST(Experiment, WrongInputIsOneClearLine) {
  EXPECT_EQ(complaint_with({}), "");
  const std::pair<std::string, std::string> cases[] = {
      {"platform.inertia_kg_m2=[[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.3]]",
       "platform.inertia_kg_m2: found principal moments 0.1, 0.1, 0.3, expected "
       "moments none of which exceeds the sum of the other two"},
      {"platform.inertia_kg_m2=[[0.1, 0.05, 0], [0, 0.1, 0], [0, 0, 0.1]]", "symmetric"},
      {"platform.mass_kg=-7.0", "platform.mass_kg: found -7, expected a number > 0"},
      {"propagate.initial_attitude=[1, 1, 0, 0]",
       "propagate.initial_attitude: found a quaternion of norm 1.41"},
      {"propagate.command=[{time_s=1, torque_N_m=[1e-4, 0, 0]}, "
       "{time_s=3, torque_N_m=[1e-4, 0, 0]}, {time_s=2, torque_N_m=[1e-4, 0, 0]}]",
       "propagate.command[2].time_s"},
      {"disturbance[1].kind=baring_drag", "did you mean \"bearing_drag\"?"},
      {"environment.gravty_m_s2=9.8", "perhaps \"gravity_m_s2\""},
      {"propagate.duration_s=0.0", "propagate.duration_s"},
      {"propagate.output_rate_Hz=1e7", "20 million"},
      {"propagate.commands='no_such_commands.csv'", "no_such_commands.csv"},
      {"disturbance[1]={kind='wheel_imbalance', axis=[0, 0, 1], dynamic_imbalance_g_cm2=1}",
       "propagate.commands: found no speed of the wheel of wheel_imbalance"},
      {"propagate.longest_step_s=1e-12", "propagate.longest_step_s"},
      {"propagate.epoch='9999-12-31T23:59:40'",
       "propagate.epoch: found an end after the year 9999"},
  };
  for (const auto& [change, words] : cases) EXPECT_THAT(complaint_with({change}), HasSubstr(words));
  EXPECT_THAT(complaint_with({}, replaced(experiment_text, "mass_kg", "mass")),
              HasSubstr("platform.mass: found a key without a unit of mass, expected the key "
                        "mass_kg"));
}

TEST(Experiment, BeginsAsItsBearingsAllow) {
  const auto about = [](const std::string& axis, const std::string& rate_rad_s,
                        const std::string& tilt_deg) {
    // A tilt towards y is a rotation about x.
    return complaint_with({"platform.topology=one_axis", "platform.axis=" + axis,
                           "propagate.initial_rate_rad_s=" + rate_rad_s,
                           "propagate.initial_tilt_deg=" + tilt_deg,
                           "propagate.initial_heading_deg=90"});
  };
  EXPECT_EQ(about("z", "[0, 0, 0.05]", "0"), "");
  EXPECT_EQ(about("x", "[0.05, 0, 0]", "10"), "");
  EXPECT_THAT(about("z", "[0, 1e-3, 0.05]", "0"), HasSubstr("propagate.initial_rate_rad_s"));
  EXPECT_THAT(about("z", "[0, 0, 0.05]", "10"), HasSubstr("propagate.initial_tilt_deg"));
  EXPECT_THAT(about("y", "[0, 0.05, 0]", "10"), HasSubstr("propagate.initial_tilt_deg"));
}

// Rz(yaw) rotates body x; a tilt towards the heading rotates body z (docs/disturbances.md).
TEST(Experiment, BeginsAtTheStatedHeadingAndYaw) {
  const std::string heading = "propagate.initial_heading_deg=-130",
                    yaw = "propagate.initial_yaw_deg=75";
  const auto begins = [&](const std::string& tilt_deg, std::vector<std::string> changes) {
    changes.push_back("propagate.initial_tilt_deg=" + tilt_deg);
    return run_with(changes).initial;
  };
  EXPECT_NEAR(heading_rad(begins("20", {heading})), -130 * degree_rad, 1e-12);
  const PlatformState both = begins("20", {heading, yaw});
  EXPECT_NEAR(heading_rad(both), -130 * degree_rad, 1e-12);
  EXPECT_NEAR(yaw_rad(both), 75 * degree_rad, 1e-12);
  EXPECT_NEAR(tilt_rad(both), 20 * degree_rad, 1e-12);
  const PlatformState over = begins("150", {heading, yaw});  // beyond the horizontal
  EXPECT_NEAR(yaw_rad(over), 75 * degree_rad, 1e-12);
  EXPECT_NEAR(tilt_rad(over), 150 * degree_rad, 1e-12);
  const Quat upright = begins("0", {heading, yaw}).lab_from_body;
  EXPECT_LT(upright.angularDistance(Quat(Eigen::AngleAxisd(75 * degree_rad, Vec3::UnitZ()))),
            1e-12);
  EXPECT_THAT(complaint_with({"propagate.initial_tilt_deg=90", "propagate.initial_yaw_deg=10"}),
              HasSubstr("propagate.initial_yaw_deg"));
}

// θ = θ₀ cos √(k/J) t of a twisted line from a turn and 60 degrees, for a third of a period.
TEST(Experiment, BeginsAfterWholeTurns) {
  PropagationRun run =
      run_with({"platform.topology=one_axis", "platform.inertia_kg_m2=0.05",
                "disturbance=[{kind='tether', stiffness_N_m_per_rad=0.02}]",
                "propagate.initial_tilt_deg=0", "propagate.initial_rate_rad_s=[0, 0, 0]",
                "propagate.initial_yaw_deg=60", "propagate.initial_turns=1",
                "propagate.duration_s=" + toml(2.0 * pi / 3.0 * std::sqrt(0.05 / 0.02))});
  run.options.tolerance = 1e-11;
  const PlatformState end = propagate(run).states.back();
  const double angle_rad = 420.0 * degree_rad * std::cos(std::sqrt(0.02 / 0.05) * end.time_s);
  EXPECT_LT(angle_rad, -pi);
  EXPECT_NEAR(std::remainder(yaw_rad(end) - angle_rad, 2.0 * pi), 0.0, 1e-7);
  EXPECT_THAT(complaint_with({"propagate.initial_turns=1"}),
              HasSubstr("propagate.initial_turns: found a platform with several axes"));
}

// A row has up to 220 bytes, 40 of them for time and quaternion. A run has at most 45,000 rows,
// that is 10 MB.
TEST(Experiment, LongRunsHaveFewerRows) {
  const auto rate = [](double duration_s) {
    return run_with({"propagate.duration_s=" + toml(duration_s)}).output_rate_Hz;
  };
  EXPECT_DOUBLE_EQ(rate(600.0), 10.0);
  EXPECT_DOUBLE_EQ(rate(4500.0), 10.0);
  EXPECT_DOUBLE_EQ(rate(4501.0), 5.0);
  EXPECT_DOUBLE_EQ(rate(86400.0), 0.5);
  for (const double duration_s : {5e3, 2e4, 1e6, 1e9}) {
    EXPECT_LE(rate(duration_s) * duration_s, 45000.0);
    EXPECT_GE(rate(duration_s) * duration_s, 45000.0 / 2.5);
  }
}

TEST(Run, GivesHistoryPlotsAndRecording) {
  const PropagationResult result = propagate(run_with());
  EXPECT_EQ(result.recording.rows(), 301u);
  EXPECT_NE(result.recording.find("gyro_z_rad_s"), nullptr);
  EXPECT_EQ(result.recording.find("command_x_N_m"), nullptr);
  const Table& history = result.product.tables.front();
  EXPECT_EQ(history.name, "time_history");
  std::set<std::string> columns, plots;
  for (const Table::Column& column : history.columns) {
    EXPECT_EQ(column.values.size(), 301u) << column.name;
    columns.insert(column.name);
  }
  for (const Plot& plot : result.product.plots) plots.insert(plot.name);
  for (const char* name : {"t_s", "q_w", "tilt_deg", "heading_deg", "yaw_deg", "rate_z_rad_s",
                           "torque_static_unbalance_x_N_m", "torque_bearing_drag_z_N_m"}) {
    EXPECT_TRUE(columns.contains(name)) << name;
  }
  for (const char* name : {"tilt", "yaw", "rates", "torques", "torque_fractions",
                           "torque_static_unbalance", "torque_bearing_drag"}) {
    EXPECT_TRUE(plots.contains(name)) << name;
  }
  EXPECT_FALSE(columns.contains("torque_gyro_bias_x_N_m"));
}

TEST(Run, RecordsTheSpeedsOfWheels) {
  const std::string file = new_file("t_s,wheel_y_rad_s\n0,10\n30,40\n", ".csv").string();
  const PropagationResult result = propagate(run_with({"propagate.commands='" + file + "'"}));
  const Channel* wheel = result.recording.find("wheel_y_rad_s");
  ASSERT_NE(wheel, nullptr);
  EXPECT_EQ(result.recording.find("wheel_x_rad_s"), nullptr);
  for (const size_t i : {0U, 150U, 300U}) {
    EXPECT_NEAR(wheel->values[i], 10.0 + result.recording.time_s[i], 1e-9) << i;
  }
}

// Drag only: the spin, the torque and the recorded rate decrease as exp(−c t/I).
TEST(Run, SpinDecaysAsItsClosedForm) {
  std::string text = experiment_text;
  text.erase(text.find("[sensors.camera]"),
             text.find("[propagate]") - text.find("[sensors.camera]"));
  const PropagationResult result = propagate(run_with(
      {"disturbance={kind='bearing_drag', coefficient_N_m_s=2e-3}", "propagate.initial_tilt_deg=0"},
      text));
  const Table& history = result.product.tables.front();
  const std::vector<double>& torque_N_m = history.column("torque_bearing_drag_z_N_m").values;
  for (size_t i = 0; i < result.recording.rows(); ++i) {
    const double rate = 0.05 * std::exp(-2e-3 / 0.183 * result.recording.time_s[i]);
    EXPECT_NEAR(result.recording.find("gyro_z_rad_s")->values[i], rate, 1e-13);
    EXPECT_NEAR(torque_N_m[i], -2e-3 * rate, 1e-15);
  }
}

TEST(Run, EndsAtTheTiltStop) {
  const PropagationResult result = propagate(
      run_with({"platform.tilt_limit_deg=12", "propagate.initial_rate_rad_s=[0, 0.05, 0]"}));
  ASSERT_EQ(result.events.size(), 1u);
  EXPECT_EQ(result.events[0].name, "tilt_stop");
  EXPECT_GT(tilt_rad(result.states.back()), 11.5 * degree_rad);
  EXPECT_LT(result.recording.time_s.back(), result.events[0].time_s + 1e-12);
  EXPECT_LT(result.recording.rows(), 30u);
  EXPECT_NEAR(tilt_rad(result.end), 12.0 * degree_rad, 1e-9);
  const Table& history = result.product.tables.front();
  EXPECT_EQ(history.column("t_s").values.back(), result.events[0].time_s);
  EXPECT_NEAR(history.column("tilt_deg").values.back(), 12.0, 1e-7);
}

// A pendulum without friction rises by I ω²/2 = m g d (1 − cos θ), between two rows 20 s apart.
TEST(Run, LargestTiltMayLieBetweenTheRows) {
  const PropagationResult result = propagate(
      run_with({"disturbance=[{kind='static_unbalance', offset_m=[0, 0, -4e-5]}]",
                "propagate.initial_tilt_deg=0", "propagate.initial_rate_rad_s=[0.05, 0, 0]",
                "propagate.output_rate_Hz=0.05"}));
  EXPECT_EQ(result.recording.rows(), 2u);
  const double largest_rad = std::acos(1.0 - 0.5 * 0.116 * 0.05 * 0.05 / (8.7 * 9.80665 * 4e-5));
  EXPECT_NEAR(find_quantity(result.product, "largest_tilt_deg")->estimate.value,
              largest_rad / degree_rad, 1e-4);
}

// A body at rest in a geostationary orbit, with the Sun at a fixed direction: one eclipse in every
// period 2 π √(r³/μ). The integrator alone would take steps of many hours.
TEST(Run, ABodyAtRestMissesNoEclipse) {
  const PropagationResult result = propagate(run_with({}, R"([platform]
topology = "free"
mass_kg = 1000
inertia_kg_m2 = [[1000, 0, 0], [0, 1100, 0], [0, 0, 1200]]
[environment.sun]
direction = [1, 0, 0.03]
[[disturbance]]
kind = "orbit"
altitude_m = 35793e3
inclination_deg = 0
[propagate]
duration_s = 864000
output_rate_Hz = 0.001
)"));
  const double period_s = 2.0 * pi * std::sqrt(std::pow(6371.2e3 + 35793e3, 3) / 3.986004418e14);
  ASSERT_EQ(result.events.size(), 20u);
  for (size_t i = 0; i + 2 < result.events.size(); ++i) {
    EXPECT_EQ(result.events[i].name, i % 2 == 0 ? "eclipse_begins" : "eclipse_ends");
    EXPECT_NEAR(result.events[i + 2].time_s - result.events[i].time_s, period_s, 1e-3);
  }
}

// The battery supplies the difference between the load and the power of the array, which is
// proportional to the cosine of the tilt.
TEST(Power, ChargeIsTheIntegralOfTheBalance) {
  AttitudeModel model;
  model.platform.inertia_kg_m2 = Vec3(0.1, 0.1, 0.1).asDiagonal();
  model.platform.battery_voltage_V = 20.0;
  model = with(model, "power_balance", "load_W = 15.0, array_power_W = 30.0");
  // A tilt that increases by 0.01 rad/s: ∫ 30 cos(0.01 t) dt = 3000 sin(0.01 t).
  const PlatformState end =
      propagated(model, state_of(model, Quat::Identity(), {0.01, 0, 0}), 100.0);
  EXPECT_NEAR(end.charge_drawn_C, (15.0 * 100.0 - 3000.0 * std::sin(1.0)) / 20.0, 1e-9);
}

// Q' = −I (1 − exp(−Q/δ)) has the solution exp(Q/δ) − 1 ∝ exp(−I t/δ).
TEST(Power, FullBatteryTakesNoMore) {
  AttitudeModel model;
  model.platform.battery_voltage_V = 10.0;
  model.platform.battery_capacity_C = 3600.0;
  model = with(model, "power_balance", "load_W = 0.0, array_power_W = 30.0");
  PlatformState start = state_of(model, Quat::Identity());
  start.charge_drawn_C = 60.0;
  const double taper_C = 0.002 * 3600;
  for (const double time_s : {10.0, 18.0, 25.0}) {
    const double expected_C =
        taper_C * std::log1p(std::expm1(60.0 / taper_C) * std::exp(-3.0 * time_s / taper_C));
    EXPECT_NEAR(propagated(model, start, time_s).charge_drawn_C, expected_C, 1e-7) << time_s;
  }
  start.charge_drawn_C = 3600.0;
  model = with(model, "power_balance", "load_W = 90.0");
  EXPECT_LE(propagated(model, start, 1000.0).charge_drawn_C, 3600.0 + 1e-6);
}

TEST(Power, TableIsMetAtItsPointsAndStaysBetweenThem) {
  const std::vector<double> tilts = {0, 10, 20, 30}, powers = {30, 29, 22, 22};
  AttitudeModel model;
  model = with(model, "power_balance",
               "load_W = 0.0, tilt_deg = " + toml(tilts) + ", power_W = " + toml(powers));
  const Dynamics dynamics(model);
  const auto power_at = [&](double tilt_deg) {
    return dynamics.at(state_of(model, turned(tilt_deg * degree_rad, {1, 1, 0}))).array_power_W[0];
  };
  for (size_t i = 0; i < tilts.size(); ++i) EXPECT_NEAR(power_at(tilts[i]), powers[i], 1e-9);
  for (double tilt = 0.5; tilt < 40; tilt += 0.5) {
    EXPECT_LE(power_at(tilt), power_at(tilt - 0.5) + 1e-9);
    EXPECT_GE(power_at(tilt), 22.0 - 1e-9);
  }
}

AttitudeModel wheeled(const std::string& further_keys) {
  AttitudeModel model;
  model.platform.inertia_kg_m2 = Vec3(0.11, 0.12, 0.19).asDiagonal();
  model.environment.gravity_lab_m_s2.setZero();
  return with(model, "wheel_control",
              "gain_N_m_per_rad = 2e-3, gain_N_m_s = 2.2e-2, wheel_inertia_kg_m2 = 1e-4, "
              "largest_torque_N_m = 2e-3, largest_rate_rad_s = 500, " +
                  further_keys);
}

Vec3 whole_momentum_lab(const AttitudeModel& model, const PlatformState& state) {
  Vec3 body = model.platform.inertia_kg_m2 * state.rate_body_rad_s;
  for (int k = 0; k < 3; ++k) {
    // The wheels' rates are absolute, and their axial inertia is part of the platform's.
    body[k] += 1e-4 * (state.extra[static_cast<size_t>(k)] - state.rate_body_rad_s[k]);
  }
  return state.lab_from_body * body;
}

TEST(Wheels, TurnThePlatformToItsTargetAndKeepTheMomentum) {
  const AttitudeModel model = wheeled("target_axis = [1, 2, 3], target_angle_deg = 40.0");
  const PlatformState start = state_of(model, turned(-1.0, {3, 1, 0}), {0.01, -0.02, 0.03});
  const Vec3 momentum = whole_momentum_lab(model, start);
  const PlatformState end = propagated(model, start, 600.0, 1e-10);
  EXPECT_LT(end.lab_from_body.angularDistance(turned(40 * degree_rad, {1, 2, 3})), 1e-6);
  EXPECT_LT(end.rate_body_rad_s.norm(), 1e-7);
  EXPECT_LT((whole_momentum_lab(model, end) - momentum).norm(), 1e-12 * momentum.norm());
}

// Feedback without an integral term has a remaining error because of the friction of the wheels.
// With the platform at rest a wheel turns on only if its motor gives c ω + τ, and the motor gives 2
// k sin(error/2).
TEST(Wheels, FrictionLeavesTheErrorThatItsTorqueNeeds) {
  const AttitudeModel model = wheeled("viscous_N_m_s = 1e-6, dry_N_m = 2e-6");
  const PlatformState start = state_of(model, Quat::Identity(), {0, 0, 0.03});
  const PlatformState end = propagated(model, start, 300.0, 1e-10);
  const double friction_N_m = 1e-6 * end.extra[2] + 2e-6;
  const double error_rad = 2.0 * std::asin(friction_N_m / (2.0 * 2e-3));
  EXPECT_GT(end.extra[2], 40.0);
  EXPECT_NEAR(2.0 * std::asin(std::abs(end.lab_from_body.z())), error_rad, 0.02 * error_rad);
}

TEST(Wheels, SaturateInTorqueAndRate) {
  // A large error saturates the motors.
  const AttitudeModel model = wheeled("target_axis = [0, 0, 1], target_angle_deg = 179.0");
  const PlatformState start = state_of(model, Quat::Identity());
  EXPECT_NEAR(torque_body_N_m(model, start).norm(), 2e-3, 0.2 * 2e-3);
  EXPECT_LT(torque_body_N_m(model, start).norm(), 2e-3);
  // A motor does not drive a wheel beyond its largest rate.
  PlatformState spun = start;
  spun.extra[2] = -520.0;
  EXPECT_LT(std::abs(torque_body_N_m(model, spun).z()), 1e-6);
  spun.extra[2] = 520.0;
  EXPECT_GT(std::abs(torque_body_N_m(model, spun).z()), 1.5e-3);
}

}  // namespace
}  // namespace photorque
