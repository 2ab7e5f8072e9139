// Laws that hold for all registered disturbances. A new kind is tested automatically; the first
// test fails if the kind has no example here.
#include <gtest/gtest.h>

#include <gmock/gmock.h>
#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/files.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

// A small wrench table, written once for the run.
std::string light_table() {
  std::ostringstream file;
  file.precision(17);
  file << "heading_deg,tilt_deg,torque_x_N_m,torque_y_N_m,torque_z_N_m\n";
  for (int heading = -180; heading < 180; heading += 15) {
    for (int tilt = 0; tilt <= 180; tilt += 10) {
      const double t = tilt * degree_rad, h = heading * degree_rad;
      file << heading << ',' << tilt << ',' << 1e-9 * std::sin(t) * std::sin(h) << ','
           << -1e-9 * std::sin(t) * std::cos(h) << ',' << 2e-10 * std::cos(t) << '\n';
    }
  }
  return test_file("law_light.csv", file.str());
}

// One example of each kind, with values large enough to matter in double precision.
std::map<std::string, std::string> examples() {
  const std::string light = light_table(), sphere = sphere_table();
  return {
      {"static_unbalance", "offset_m = [2e-5, -1e-5, -3e-5]"},
      {"mass_shift", "time_s = 5, offset_m = [1e-5, 2e-5, 1e-6]"},
      {"battery_discharge", "shift_m_per_Ah = [3e-6, -1e-6, 2e-6]"},
      {"elastic_sag", "compliance_s2 = [[3e-6, 1e-7, 0], [1e-7, 2e-6, 0], [0, 0, 1e-6]]"},
      {"stepper_quantization", "moving_mass_kg = 0.25, lead_m = 2e-3"},
      {"bearing_drag", "axial_N_m_s = 2e-5, transverse_N_m_s = 3e-5"},
      {"turbine_torque", "torque_N_m = 3e-6"},
      {"dry_friction", "torque_N_m = 2e-6"},
      {"air_friction", "coefficient = 4e-5"},
      {"air_pressure_drag", "coefficient_N_m_s2 = 7e-4"},
      {"room_draft", "torque_lab_N_m = [0, 0, 2e-6]"},
      {"lamp_pressure", "torque_lab_N_m = [0, 0, 2e-6], led_current_A = 0.7"},
      {"magnetic_dipole", "dipole_A_m2 = [0.01, 0.03, -0.02]"},
      {"helmholtz_cage", "gain_error = 0.1"},
      {"eddy_damping", "coefficient_N_m_s_per_T2 = 40"},
      {"radiation_pressure", "table = " + toml(light)},
      {"planet_light", "table = " + toml(sphere) + ", sun_direction = [1, 0.3, 0.2]"},
      {"aerodynamic_drag", "table = " + toml(sphere) + ", density_kg_m3 = 1e-8"},
      {"gravity_gradient", ""},
      {"earth_rotation", ""},
      {"wheel_momentum", "inertia_kg_m2 = [1e-4, 2e-4, 3e-4]"},
      {"rotor_momentum", "momentum_N_m_s = [4e-4, -2e-3, -1e-3]"},
      {"tether", "stiffness_N_m_per_rad = 2e-4"},
      {"floor_vibration", "acceleration_m_s2 = [0, 0, 0.02], frequency_Hz = 0.3, phase = 0.4"},
      {"periodic_torque", "torque_N_m = [1e-5, -5e-5, -2e-5], frequency_Hz = 0.7, phase = 2.6"},
      {"flexible_mode",
       "axis = [1, 0.5, 0], frequency_Hz = 0.4, damping = 0.02, inertia_kg_m2 = 0.03"},
      {"wheel_imbalance",
       "axis = [0.2, -1, 0.4], static_imbalance_g_cm = 30.0, position_m = [0.1, 0.2, -0.1], "
       "dynamic_imbalance_g_cm2 = 200.0, dynamic_phase_deg = 20.0"},
      {"actuator_latency", "latency_s = 0.05"},
      {"actuator_gain", "gain_error = [0.1, 0.2, -0.1]"},
      {"inertia_error", "delta_kg_m2 = [0.003, -0.002, 0.004, 0.001, -0.001, 0.002]"},
      {"gravity_tilt", "tilt_rad = [1e-3, -2e-3]"},
      {"attitude_latency", "latency_s = 0.05"},
      {"gyro_bias", "bias_rad_s = [1e-3, -1e-3, 2e-3]"},
      {"gyro_scale", "scale = [0.01, -0.02, 0.01]"},
      {"gyro_misalignment", "misalignment_rad = [1e-3, 2e-3, -1e-3]"},
      {"orbit",
       "altitude_km = 500, inclination_deg = 51, phase_deg = 30, date_year = 2026, "
       "duration_s = 600, sun_direction = [1, 0.3, 0.2]"},
      {"power_balance", "load_W = 25, array_power_W = 30"},
      {"wheel_control",
       "gain_N_m_per_rad = 0.01, gain_N_m_s = 0.05, wheel_inertia_kg_m2 = 1e-3, "
       "largest_torque_N_m = 0.5, largest_rate_rad_s = 500, viscous_N_m_s = 1e-6"},
      {"table_slope", "slope_rad = [1e-3, -2e-3]"},
      {"sliding_friction", "coefficient = 2e-3"},
      {"sliding_drag", "coefficient_kg_s = 0.3"},
      {"sliding_air_drag", "coefficient_kg_m = 2.0"},
      {"body_force", "force_N = [0.2, -0.1]"},
      {"thrust_saturation", "loss_at_one_newton = 0.8"},
      {"mass_error", "delta_kg = 0.05"},
      {"sliding_spring", "stiffness_N_per_m = 0.7, pull_N = [0.1, -0.2]"},
      {"camera_misalignment", "misalignment_rad = [1e-3, 2e-3, -1e-3]"},
      {"marker_positions", "marker = 2, error_m = [2e-4, -1e-4, 3e-4]"},
      {"empirical_torque",
       "axes = ['lean', 'rate'], tilt_exponent = 1.7, rate_knots_rad_s = [0.0, 0.05, 0.1, 0.25, "
       "0.3], coefficients_N_m = [1e-6, 2e-6, -3e-6, 4e-6, 5e-6, 1e-6, 2e-6, 3e-6, 4e-6, 1e-6]"},
  };
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const DisturbanceKind& kind : all_disturbance_kinds()) names.push_back(kind.name);
  return names;
}

AttitudeModel commanded_bench() {
  AttitudeModel model = bench_model();
  model.schedule.append(0.0, {.command_body_N_m = {1e-4, -2e-4, 3e-4},
                              .force_lab_N = {0.3, -0.2, 0.0},
                              .force_body_N = {0.1, 0.4, 0.0},
                              .battery_current_A = 2.0,
                              .led_current_A = 0.3,
                              .lamps_as_stated = 0.0,
                              .wheel = {0.0, {20.0, -10.0, 30.0}, {0.3, 0.2, -0.1}}});
  return model;
}

// The model in which a kind is tested: with an offset for kinds that need one, the field and a
// command.
AttitudeModel model_with(const std::string& kind) {
  AttitudeModel model = commanded_bench();
  // Forces act on sliding bodies.
  const DisturbanceKind* known = find_kind(kind);
  if (known != nullptr && is_force(known->screening.needs)) {
    model.platform.topology = Topology::planar;
    model.disturbances.push_back(translation());
  }
  model = with(model, "static_unbalance", "offset_m = [1e-6, 2e-6, -2e-5]");
  model = with(model, "magnetic_dipole", "dipole_A_m2 = [0.01, -0.02, 0.005]");
  const auto all = examples();
  const auto example = all.find(kind);
  if (example == all.end()) {
    ADD_FAILURE() << "give an example of " << kind << " in examples()";
    return model;
  }
  return with(model, kind, example->second);
}

Vec3 random_vector(std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  const double x = normal(engine), y = normal(engine), z = normal(engine);
  return {x, y, z};
}

PlatformState random_state(const AttitudeModel& model, std::mt19937_64& engine) {
  const Vec3 axis = random_vector(engine), rate = 0.1 * random_vector(engine);
  const double angle = std::uniform_real_distribution<double>(0.0, 2.8)(engine);
  PlatformState state = state_of(model, turned(angle, axis), rate, 7.3, 900.0);
  for (double& extra : state.extra) extra += 0.01 * random_vector(engine).x();
  return state;
}

std::vector<double> rates_of(const Dynamics& dynamics, double time_s,
                             const std::vector<double>& y) {
  std::vector<Lanes> lanes(y.begin(), y.end()), rates(y.size(), Lanes(0.0));
  dynamics.rates(Lanes(time_s), dynamics.model().schedule.at(time_s), lanes.data(), rates.data());
  std::vector<double> values;
  for (const Lanes& rate : rates) values.push_back(rate[0]);
  return values;
}

class EveryDisturbance : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Kind, EveryDisturbance, testing::ValuesIn(kind_names()),
                         [](const auto& kind) { return kind.param; });

TEST_P(EveryDisturbance, IsFiniteAtRestUprightAndUpsideDown) {
  const AttitudeModel model = model_with(GetParam());
  const Dynamics dynamics(model);
  for (const Quat& q : {Quat::Identity(), turned(pi, Vec3::UnitX()), turned(1e-12, {1, 1, 1})}) {
    const std::vector<double> y = to_vector(state_of(model, q, Vec3::Zero(), 17.3));
    for (const double rate : rates_of(dynamics, 17.3, y)) EXPECT_TRUE(std::isfinite(rate));
    std::vector<Lanes> lanes(y.begin(), y.end());
    std::vector<Lanes> derivatives(y.size() * DualLanes::block, Lanes(0.0));
    Dynamics::Block block;
    for (int k = 0; k < DualLanes::block; ++k) block.state[k] = k;
    Dynamics::Workspace room;
    dynamics.derivatives(Lanes(17.3), model.schedule.at(17.3), lanes.data(), block,
                         derivatives.data(), room);
    for (const Lanes& derivative : derivatives) EXPECT_TRUE(std::isfinite(derivative[0]));
  }
}

TEST_P(EveryDisturbance, IsTheSameForBothQuaternionsOfAnAttitude) {
  const AttitudeModel model = model_with(GetParam());
  std::mt19937_64 engine(3);
  for (int i = 0; i < 5; ++i) {
    PlatformState state = random_state(model, engine);
    const Vec3 torque = torque_body_N_m(model, state);
    state.lab_from_body.coeffs() *= -1.0;
    EXPECT_LT((torque_body_N_m(model, state) - torque).norm(), 1e-13 * (torque.norm() + 1e-12));
  }
}

// Column of exact derivatives of dy/dt by one component of the state or one parameter.
std::vector<double> exact_column(const Dynamics& dynamics, double time_s,
                                 const std::vector<double>& y, int component, int parameter) {
  const std::vector<Lanes> lanes(y.begin(), y.end());
  Dynamics::Block block;
  block.state[0] = component;
  block.parameter[0] = parameter;
  std::vector<Lanes> all(y.size() * DualLanes::block, Lanes(0.0));
  Dynamics::Workspace room;
  dynamics.derivatives(Lanes(time_s), dynamics.model().schedule.at(time_s), lanes.data(), block,
                       all.data(), room);
  std::vector<double> column;
  for (size_t c = 0; c < y.size(); ++c) column.push_back(all[c * DualLanes::block][0]);
  return column;
}

void expect_slope(const std::vector<double>& derivative, const std::vector<double>& above,
                  const std::vector<double>& below, double step, const std::string& what) {
  double size = 0.0;
  for (const double d : derivative) size = std::max(size, std::abs(d));
  for (size_t c = 0; c < derivative.size(); ++c) {
    // The error of a difference is of second order in the step, plus the rounding error divided by
    // the step.
    EXPECT_NEAR(derivative[c], (above[c] - below[c]) / (2 * step), 2e-6 * size + 1e-9)
        << what << ", component " << c;
  }
}

double step_of(const std::vector<Parameter>& parameters, const Parameter& parameter) {
  double size = 0.0;
  for (const Parameter& p : parameters) {
    if (p.key == parameter.key) size = std::max(size, std::abs(p.value));
  }
  return 2e-5 * (size > 0.0 ? size : 1.0);
}

void expect_parameter_slopes(const AttitudeModel& model, size_t d, const PlatformState& state) {
  const Dynamics dynamics(model);
  const std::vector<double> y = to_vector(state);
  const std::vector<Parameter>& parameters = model.disturbances[d].parameters;
  for (size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].key == "time_s") continue;  // the instant of a jump
    const double step = step_of(parameters, parameters[p]);
    const auto moved = [&](double by) {
      AttitudeModel other = model;
      other.disturbances[d].parameters[p].value += by;
      return rates_of(Dynamics(other), state.time_s, y);
    };
    const int index = dynamics.first_parameter(d) + static_cast<int>(p);
    expect_slope(exact_column(dynamics, state.time_s, y, -1, index), moved(step), moved(-step),
                 step, model.disturbances[d].kind + "." + parameters[p].key);
  }
}

void expect_state_slopes(const AttitudeModel& model, const PlatformState& state) {
  const Dynamics dynamics(model);
  const std::vector<double> y = to_vector(state);
  for (size_t i = 0; i < y.size(); ++i) {
    const double step = 1e-5;
    std::vector<double> above = y, below = y;
    above[i] += step;
    below[i] -= step;
    expect_slope(exact_column(dynamics, state.time_s, y, static_cast<int>(i), -1),
                 rates_of(dynamics, state.time_s, above), rates_of(dynamics, state.time_s, below),
                 step, "state " + std::to_string(i));
  }
}

// Derivatives that the laws compute exactly, compared with central differences by all components of
// the state and all parameters except instants of jumps.
TEST_P(EveryDisturbance, DerivativesAgreeWithCentralDifferences) {
  const AttitudeModel model = model_with(GetParam());
  std::mt19937_64 engine(11);
  const PlatformState state = random_state(model, engine);
  expect_state_slopes(model, state);
  expect_parameter_slopes(model, model.disturbances.size() - 1, state);
}

// Derivatives with all disturbances at once: the torque of one may depend on changes of the field,
// the centre of mass or the inertia by another.
TEST(Disturbances, DerivativesAgreeWhenAllActTogether) {
  AttitudeModel model = commanded_bench();
  for (const auto& [kind, entries] : examples()) model = with(model, kind, entries);
  std::mt19937_64 engine(11);
  const PlatformState state = random_state(model, engine);
  expect_state_slopes(model, state);
  for (size_t d = 0; d < model.disturbances.size(); ++d) {
    if (model.disturbances[d].stage != Stage::measurement) expect_parameter_slopes(model, d, state);
  }
}

// A rotation of the whole laboratory about the vertical, with its field and the Earth's axis, has
// no effect, for all kinds without a horizontal direction.
std::vector<std::string> kinds_without_heading() {
  static const std::map<std::string, std::string> headed = {
      {"tether", "pulls to zero attitude"},
      {"wheel_control", "turns to a target attitude"},
      {"gravity_tilt", "is about lab axes"},
      {"planet_light", "is in inertial axes"},
      {"orbit", "is in inertial axes"}};
  std::vector<std::string> names;
  for (const std::string& name : kind_names()) {
    if (!headed.contains(name)) names.push_back(name);
  }
  return names;
}

class EveryKindWithoutHeading : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Kind, EveryKindWithoutHeading, testing::ValuesIn(kinds_without_heading()),
                         [](const auto& kind) { return kind.param; });

TEST_P(EveryKindWithoutHeading, DoesNotDependOnNorth) {
  const AttitudeModel model = model_with(GetParam());
  std::mt19937_64 engine(5);
  for (const double angle : {0.7, 2.9, -1.3}) {
    const Quat turn = turned(angle, Vec3::UnitZ());
    AttitudeModel turned_model = model;
    turned_model.environment.magnetic_field_lab_T = turn * model.environment.magnetic_field_lab_T;
    turned_model.environment.earth_rate_lab_rad_s = turn * model.environment.earth_rate_lab_rad_s;
    PlatformState state = random_state(model, engine);
    const Vec3 torque = torque_body_N_m(model, state);
    state.lab_from_body = turn * state.lab_from_body;
    EXPECT_LT((torque_body_N_m(turned_model, state) - torque).norm(),
              1e-12 * (torque.norm() + 1e-12));
  }
}

// Every drag: T·ω < 0 in motion and T = 0 at rest.
class EveryDrag : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Kind, EveryDrag,
                         testing::Values("bearing_drag", "dry_friction", "air_friction",
                                         "air_pressure_drag", "eddy_damping"),
                         [](const auto& kind) { return kind.param; });

TEST_P(EveryDrag, TakesPowerInMotionAndIsNothingAtRest) {
  const AttitudeModel model = model_with(GetParam());
  std::mt19937_64 engine(7);
  for (int i = 0; i < 200; ++i) {
    PlatformState state = random_state(model, engine);
    EXPECT_LT(torque_body_N_m(model, state).dot(state.rate_body_rad_s), 0.0);
    state.rate_body_rad_s.setZero();
    EXPECT_EQ(torque_body_N_m(model, state).norm(), 0.0);
  }
}

// Torques with a potential: T·ω is minus the rate of change of the potential, which is written here
// independently of the law. The torque of a rotor does no work: its potential is zero.
class EveryPotential : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Kind, EveryPotential,
                         testing::Values("static_unbalance", "magnetic_dipole", "gravity_gradient",
                                         "tether", "elastic_sag", "rotor_momentum"),
                         [](const auto& kind) { return kind.param; });

double potential_J(const AttitudeModel& model, const Quat& q) {
  const Platform& p = model.platform;
  const Environment& e = model.environment;
  const Disturbance& d = model.disturbances.back();
  const auto number = [&](size_t i) { return d.parameters[i].value; };
  const auto vector = [&] { return Vec3(number(0), number(1), number(2)); };
  if (d.kind == "static_unbalance") return -p.mass_kg * (q * vector()).dot(e.gravity_lab_m_s2);
  if (d.kind == "magnetic_dipole") return -(q * vector()).dot(e.magnetic_field_lab_T);
  if (d.kind == "gravity_gradient") {
    const Vec3 up = q.conjugate() * e.up_lab;
    return 1.5 * e.gravity_gradient_1_s2 * up.dot(p.inertia_kg_m2 * up);
  }
  if (d.kind == "tether") {
    const double angle = q.angularDistance(Quat::Identity());
    return 0.5 * number(0) * angle * angle;
  }
  if (d.kind == "elastic_sag") {
    Mat3 compliance_s2;
    for (int i = 0; i < 9; ++i) compliance_s2(i / 3, i % 3) = number(static_cast<size_t>(i));
    const Vec3 change = q.conjugate() * e.gravity_lab_m_s2 - e.gravity_lab_m_s2;
    return -0.5 * p.mass_kg * change.dot(compliance_s2 * change);
  }
  return 0.0;
}

TEST_P(EveryPotential, TorqueIsMinusItsSlope) {
  const AttitudeModel model = model_with(GetParam());
  std::mt19937_64 engine(13);
  for (int i = 0; i < 10; ++i) {
    const PlatformState state = random_state(model, engine);
    const Vec3 torque = torque_body_N_m(model, state);
    const Vec3& rate = state.rate_body_rad_s;
    const double step_s = 1e-3;
    const double ahead =
        potential_J(model, state.lab_from_body * turned(rate.norm() * step_s, rate));
    const double behind =
        potential_J(model, state.lab_from_body * turned(-rate.norm() * step_s, rate));
    EXPECT_NEAR(torque.dot(rate), -(ahead - behind) / (2 * step_s),
                1e-5 * torque.norm() * rate.norm() + 1e-15);
  }
}

TEST_P(EveryDisturbance, RejectsAnUnknownKey) {
  const auto all = examples();
  if (!all.contains(GetParam())) return;
  const std::string& keys = all.at(GetParam());
  EXPECT_NO_THROW(make(bench_model(), GetParam(), keys));
  EXPECT_THROW(make(bench_model(), GetParam(), keys + (keys.empty() ? "" : ", ") + "colour = 1"),
               InputError);
}

// Errors for kinds of disturbance that do not exist.

TEST(Disturbances, UnknownKindIsOneClearLine) {
  EXPECT_THAT(refusal_of([&] { make(bench_model(), "bearing_drug"); }),
              testing::HasSubstr("bearing_drag"));
}

// A disturbance that sets the field, the rotation of the laboratory or the battery current for all
// others may be used only once.
TEST(Disturbances, ThatSetTheSameForAllAreRefusedTwice) {
  const std::string cage = "{kind = 'helmholtz_cage', field_lab_T = [1e-5, 0, 0]}",
                    orbit = "{kind = 'orbit', altitude_m = 5e5, inclination_deg = 50}",
                    rotation = "{kind = 'earth_rotation'}",
                    load = "{kind = 'power_balance', load_W = 10}";
  const AttitudeModel model = bench_model();
  const auto read = [&](const std::vector<std::string>& all) {
    return read_disturbances(settings_of("disturbance = [" + joined_text(all, ", ") + "]"),
                             context_of(model));
  };
  for (const auto& pair : std::vector<std::vector<std::string>>{
           {cage, cage}, {cage, orbit}, {orbit, cage}, {rotation, rotation}, {load, load}}) {
    EXPECT_THROW(read(pair), InputError);
  }
  EXPECT_EQ(read({cage, rotation, load}).size(), 3u);
}

}  // namespace
}  // namespace photorque
