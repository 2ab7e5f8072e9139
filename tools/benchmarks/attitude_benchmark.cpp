// Speed and accuracy of the propagator: a free body for 1e5 s compared with classical Runge–Kutta,
// a day of the tabletop platform with every disturbance, and ten minutes with and without
// derivatives.
#include <benchmark/benchmark.h>

#include "attitude/propagation/run.h"
#include "core/constants.h"

namespace photorque {
namespace {

using Values = std::vector<std::pair<std::string, std::vector<double>>>;

// Reference: a free body with I = diag(500, 200, 300) kg m² after 1e5 s from zero attitude. The
// final attitude comes from a Taylor method of order 40 in quadruple precision.
const Vec3 moments_kg_m2(500, 200, 300), initial_rate_rad_s(0.5, -0.4, 0.7);
const Quat final_attitude(5.9442666266515225370e-01, -7.7701057464352362963e-01,
                          -2.0709558729710917510e-01, -4.7882488423132890032e-03);
constexpr double duration_s = 1e5;

double error_rad(const Quat& q) {
  const Quat e = final_attitude.conjugate() * q.normalized();
  return 2.0 * std::atan2(e.vec().norm(), std::abs(e.w()));
}

// Argument: −log10 of the tolerance.
void free_body(benchmark::State& state) {
  AttitudeModel model;
  model.platform.inertia_kg_m2 = moments_kg_m2.asDiagonal();
  const Dynamics dynamics(model);
  PropagationOptions options;
  options.tolerance = std::pow(10.0, -static_cast<double>(state.range(0)));
  Trajectory trajectory;
  for (auto _ : state) {
    trajectory = propagate(dynamics, dynamics.initial_state(initial_rate_rad_s),
                           std::vector<double>{duration_s}, options);
  }
  const PlatformState& end = trajectory.states.back();
  const Vec3 momentum = moments_kg_m2.cwiseProduct(end.rate_body_rad_s);
  state.counters["attitude_error_rad"] = error_rad(end.lab_from_body);
  state.counters["energy_error"] = std::abs(end.rate_body_rad_s.dot(momentum) / 304.0 - 1.0);
  state.counters["momentum_error"] = std::abs(momentum.norm() / std::sqrt(113000.0) - 1.0);
  state.counters["steps"] = static_cast<double>(trajectory.statistics.steps);
}
BENCHMARK(free_body)->Arg(7)->Arg(8)->Arg(9)->Arg(10)->Unit(benchmark::kMillisecond);

// Classical Runge–Kutta, the method of most simulators. Argument: step in ms.
void free_body_runge_kutta_4(benchmark::State& state) {
  const double h = 1e-3 * static_cast<double>(state.range(0));
  using State = Eigen::Matrix<double, 7, 1>;
  const auto rate = [](const State& y) {
    const Quat q(y[0], y[1], y[2], y[3]);
    const Vec3 w = y.tail<3>();
    const Quat dq = q * Quat(0.0, 0.5 * w.x(), 0.5 * w.y(), 0.5 * w.z());
    State d;
    d << dq.w(), dq.x(), dq.y(), dq.z(),
        (moments_kg_m2.cwiseProduct(w)).cross(w).cwiseQuotient(moments_kg_m2);
    return d;
  };
  State y;
  for (auto _ : state) {
    y << 1.0, 0.0, 0.0, 0.0, initial_rate_rad_s;
    const auto steps = static_cast<int64_t>(std::llround(duration_s / h));
    for (int64_t i = 0; i < steps; ++i) {
      const State a = rate(y), b = rate(y + 0.5 * h * a), c = rate(y + 0.5 * h * b);
      y += h / 6.0 * (a + 2.0 * b + 2.0 * c + rate(y + h * c));
      y.head<4>().normalize();
    }
  }
  state.counters["attitude_error_rad"] = error_rad(Quat(y[0], y[1], y[2], y[3]));
}
BENCHMARK(free_body_runge_kutta_4)->Arg(100)->Arg(10)->Unit(benchmark::kMillisecond);

AttitudeModel tabletop() {
  AttitudeModel model;
  model.platform.mass_kg = 7.0;
  model.platform.inertia_kg_m2 = Vec3(0.11, 0.12, 0.19).asDiagonal();
  model.environment.magnetic_field_lab_T = {1e-6, 2.2e-5, -4.2e-5};
  model.environment.latitude_rad = 45.5 * degree_rad;
  model.environment.earth_rate_lab_rad_s =
      earth_rate_rad_s * Vec3(0.0, std::cos(45.5 * degree_rad), std::sin(45.5 * degree_rad));
  return model;
}

void add(AttitudeModel& model, const std::string& kind, const Values& values) {
  model.disturbances.push_back(
      make_disturbance_of(kind, values, {model.platform, model.environment}));
}

// Every disturbance of the catalogue that acts on a platform in a laboratory and needs no file,
// with typical magnitudes of a good platform. The floor shakes at 12 Hz, an appendage swings at 2
// Hz.
AttitudeModel everything() {
  AttitudeModel model = tabletop();
  const std::vector<std::pair<std::string, Values>> all = {
      {"static_unbalance", {{"offset_m", {2e-6, -1e-6, -3e-5}}}},
      {"mass_shift", {{"time_s", {3600.0}}, {"offset_m", {1e-6, 0, 0}}}},
      {"battery_discharge", {{"shift_m_per_Ah", {1e-8, 0, 0}}}},
      {"elastic_sag", {{"compliance_s2", {1e-9, 1e-9, 2e-9}}}},
      {"stepper_quantization", {{"moving_mass_kg", {0.25}}, {"lead_m", {2e-3}}}},
      {"bearing_drag", {{"coefficient_N_m_s", {1.5e-5}}}},
      {"turbine_torque", {{"torque_N_m", {1e-6}}}},
      {"dry_friction", {{"torque_N_m", {1e-7}}}},
      {"air_friction", {{"coefficient", {1e-5}}}},
      {"air_pressure_drag", {{"coefficient_N_m_s2", {1e-4}}}},
      {"room_draft", {{"torque_lab_N_m", {1e-7, 1e-7, 0}}}},
      {"magnetic_dipole", {{"dipole_A_m2", {0.01, 0.02, 0.01}}}},
      {"eddy_damping", {{"coefficient_N_m_s_per_T2", {100.0}}}},
      {"gravity_gradient", {}},
      {"earth_rotation", {}},
      {"rotor_momentum", {{"momentum_N_m_s", {0, 0, 1e-4}}}},
      {"tether", {{"stiffness_N_m_per_rad", {1e-6}}}},
      {"floor_vibration", {{"acceleration_m_s2", {1e-3, 1e-3, 1e-3}}, {"frequency_Hz", {12.0}}}},
      {"periodic_torque", {{"torque_N_m", {1e-6, 0, 0}}, {"frequency_Hz", {0.1}}}},
      {"flexible_mode",
       {{"axis", {1, 0, 0}},
        {"frequency_Hz", {2.0}},
        {"damping", {0.01}},
        {"inertia_kg_m2", {0.002}}}},
      {"actuator_gain", {{"gain_error", {0.02}}}},
      {"inertia_error", {{"delta_kg_m2", {1e-4, 0, 0, 0, 0, 0}}}},
      {"gravity_tilt", {{"tilt_rad", {1e-4, -1e-4}}}},
      {"power_balance", {{"load_W", {15.0}}, {"array_power_W", {14.0}}}},
      {"gyro_bias", {{"bias_rad_s", {1e-3, 0, 0}}}},
      {"gyro_scale", {{"scale", {1e-3, 0, 0}}}},
      {"gyro_misalignment", {{"misalignment_rad", {1e-3, 0, 0}}}},
      {"camera_misalignment", {{"misalignment_rad", {1e-3, 0, 0}}}},
  };
  for (const auto& [kind, values] : all) add(model, kind, values);
  for (int hour = 0; hour < 24; ++hour) {
    const double at_s = 3600.0 * hour;
    model.schedule.append(at_s, {.command_body_N_m = {2e-5, 0, 1e-5}, .battery_current_A = 0.1});
    model.schedule.append(at_s + 10.0, {.command_body_N_m = {0, 0, 0}, .battery_current_A = 0.1});
  }
  return model;
}

PropagationRun day() {
  PropagationRun run;
  run.model = everything();
  run.sensors = perfect_sensors();
  run.sensors.camera = Sensors::Camera{};
  run.sensors.gyro->noise_rad_s = 2e-4;
  run.duration_s = 86400.0;
  run.output_rate_Hz = 1.0;
  run.initial = Dynamics(run.model).initial_state({0.01, -0.01, 0.002});
  run.initial.lab_from_body = Quat(Eigen::AngleAxisd(0.1, Vec3(1, 1, 0).normalized()));
  return run;
}

// A whole day with recording, time history and plots; checks that a second run has the same bits.
void day_of_everything(benchmark::State& state) {
  const PropagationRun run = day();
  std::vector<double> first;
  PropagationResult result;
  for (auto _ : state) {
    result = propagate(run);
    const std::vector<double> end = to_vector(result.states.back());
    if (first.empty()) first = end;
    if (end != first) state.SkipWithError("two runs differ");
  }
  state.counters["steps"] = static_cast<double>(result.statistics.steps);
  state.counters["rejected"] = static_cast<double>(result.statistics.rejected);
  state.counters["disturbances"] = static_cast<double>(run.model.disturbances.size());
}
BENCHMARK(day_of_everything)->Unit(benchmark::kSecond)->Iterations(2);

// Ten minutes at 10 Hz; argument: number of variables of the derivatives.
void ten_minutes(benchmark::State& state, const AttitudeModel& model) {
  const Dynamics dynamics(model);
  const PlatformState start = dynamics.initial_state({0.01, -0.01, 0.1});
  std::vector<double> times_s;
  for (int i = 0; i <= 6000; ++i) times_s.push_back(0.1 * i);
  std::vector<Variable> variables;
  for (int i = 0; i < 6; ++i) variables.push_back({i, 0, -1});
  for (size_t d = 0; d < model.disturbances.size(); ++d) {
    for (size_t p = 0; p < model.disturbances[d].parameters.size(); ++p) {
      variables.push_back(Variable::of(d, static_cast<int>(p)));
    }
  }
  variables.resize(std::min(variables.size(), static_cast<size_t>(state.range(0))));
  Trajectory trajectory;
  for (auto _ : state) trajectory = propagate(dynamics, start, times_s, {}, variables);
  state.counters["variables"] = static_cast<double>(variables.size());
  state.counters["steps"] = static_cast<double>(trajectory.statistics.steps);
}
void ten_minutes_of_a_pendulum(benchmark::State& state) {
  AttitudeModel model = tabletop();
  add(model, "static_unbalance", {{"offset_m", {2e-6, -1e-6, -3e-5}}});
  add(model, "bearing_drag", {{"coefficient_N_m_s", {1.5e-5}}});
  ten_minutes(state, model);
}
void ten_minutes_of_everything(benchmark::State& state) {
  ten_minutes(state, everything());
}
BENCHMARK(ten_minutes_of_a_pendulum)->Arg(0)->Arg(10)->Unit(benchmark::kMillisecond);
BENCHMARK(ten_minutes_of_everything)->Arg(0)->Arg(10)->Arg(100)->Unit(benchmark::kMillisecond);

// One attempt of a step, for the free body and for the platform with all disturbances.
void one_step(benchmark::State& state, const AttitudeModel& model) {
  const Dynamics dynamics(model);
  CollocationStep step(dynamics, 0.0, to_vector(dynamics.initial_state({0.01, -0.01, 0.1})));
  const double h_s = 0.05;
  step.attempt(h_s, {}, 1e-18);
  step.accept(h_s);
  for (auto _ : state) benchmark::DoNotOptimize(step.attempt(h_s, {}, 1e-18));
}
void step_of_a_free_body(benchmark::State& state) {
  one_step(state, tabletop());
}
void step_of_everything(benchmark::State& state) {
  one_step(state, everything());
}
BENCHMARK(step_of_a_free_body)->Unit(benchmark::kMicrosecond);
BENCHMARK(step_of_everything)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace photorque

BENCHMARK_MAIN();
