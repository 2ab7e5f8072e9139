#include "tools/proof/recipes.h"

#include <algorithm>

namespace photorque::injected {
namespace {

using Case = InjectedCase;

std::vector<double> list(const Triple& v) {
  return {v.begin(), v.end()};
}

// An effect whose only number is a vector of random direction.
std::function<InjectedEffect(RandomDraw&, const Case&)> vector_of(const std::string& kind,
                                                                  const std::string& key,
                                                                  double size) {
  return [=](RandomDraw& draw, const Case&) {
    return InjectedEffect{kind, {{key, list(times(size, draw.direction()))}}};
  };
}

std::function<InjectedEffect(RandomDraw&, const Case&)> number_of(const std::string& kind,
                                                                  const std::string& key,
                                                                  double size,
                                                                  bool either_sign = false) {
  return [=](RandomDraw& draw, const Case&) {
    return InjectedEffect{kind, {{key, {either_sign ? draw.sign() * size : size}}}};
  };
}

std::function<InjectedEffect(RandomDraw&, const Case&)> nothing_of(const std::string& kind) {
  return [=](RandomDraw&, const Case&) { return InjectedEffect{kind, {}}; };
}

// Slow enough for four readings a period.
double frequency_Hz(RandomDraw& draw, const Case& c) {
  return draw.log_uniform(0.15, std::min(3.0, 0.25 * c.sensors.rate_Hz / c.sensors.camera_every));
}

InjectedEffect mass_shift(RandomDraw& draw, const Case& c) {
  const double time_s = draw.uniform(0.25, 0.65) * c.runs[0].duration_s;
  return {"mass_shift",
          {{"time_s", {std::round(10.0 * time_s) / 10.0}},
           {"offset_m", list(times(2e-6, draw.direction()))}}};
}

InjectedEffect elastic_sag(RandomDraw& draw, const Case&) {
  return {"elastic_sag",
          {{"compliance_s2",
            {draw.uniform(0.2e-7, 1e-7), draw.uniform(0.2e-7, 1e-7), draw.uniform(0.2e-7, 1e-7)}}}};
}

InjectedEffect floor_vibration(RandomDraw& draw, const Case& c) {
  return {"floor_vibration",
          {{"acceleration_m_s2", list(times(0.05, draw.direction()))},
           {"frequency_Hz", {frequency_Hz(draw, c)}},
           {"phase", {draw.uniform(-3.1, 3.1)}}}};
}

InjectedEffect periodic_torque(RandomDraw& draw, const Case& c) {
  return {"periodic_torque",
          {{"torque_N_m", list(times(5e-5, draw.direction()))},
           {"frequency_Hz", {frequency_Hz(draw, c)}},
           {"phase", {draw.uniform(-3.1, 3.1)}}}};
}

InjectedEffect flexible_mode(RandomDraw& draw, const Case& c) {
  const Triple axis = draw.direction();
  double about_axis = 0.0;
  for (size_t k = 0; k < 3; ++k) about_axis += axis[k] * axis[k] * c.world.inertia_kg_m2[k][k];
  return {"flexible_mode",
          {{"axis", list(axis)},
           {"frequency_Hz", {draw.log_uniform(0.15, 1.5)}},
           {"damping", {draw.log_uniform(0.005, 0.05)}},
           {"inertia_kg_m2", {0.05 * about_axis}}}};
}

InjectedEffect inertia_error(RandomDraw& draw, const Case& c) {
  std::vector<double> delta;
  double mean = 0.0;
  for (size_t k = 0; k < 3; ++k) {
    const double own = c.world.inertia_kg_m2[k][k];
    delta.push_back(0.01 * draw.uniform(-1.0, 1.0) * own);
    mean += own / 3.0;
  }
  for (int k = 0; k < 3; ++k) delta.push_back(0.005 * draw.uniform(-1.0, 1.0) * mean);
  return {"inertia_error", {{"delta_kg_m2", delta}}};
}

InjectedEffect gravity_tilt(RandomDraw& draw, const Case&) {
  return {"gravity_tilt", {{"tilt_rad", {2e-3 * draw.normal(), 2e-3 * draw.normal()}}}};
}

InjectedEffect heading_cogging(RandomDraw& draw, const Case&) {
  return {"heading_cogging",
          {{"torque_N_m", {5e-6}},
           {"periods", {static_cast<double>(2 + draw.below(4))}},
           {"phase", {draw.uniform(-3.1, 3.1)}}}};
}

InjectedEffect slow_random_torque(RandomDraw& draw, const Case&) {
  return {"slow_random_torque",
          {{"torque_N_m", list(times(3e-6, {draw.uniform(0, 1), draw.uniform(0, 1), 1.0}))},
           {"time_s", {draw.log_uniform(15.0, 50.0)}},
           {"seed", {std::floor(draw.uniform(1, 1e6))}}}};
}

InjectedEffect exponential_decay(RandomDraw& draw, const Case&) {
  return {"exponential_decay",
          {{"torque_N_m", list(times(5e-6, draw.direction()))},
           {"time_s", {draw.log_uniform(20.0, 120.0)}}}};
}

InjectedEffect pulsed_torque(RandomDraw& draw, const Case&) {
  return {"pulsed_torque",
          {{"torque_N_m", list(times(5e-6, draw.direction()))},
           {"period_s", {draw.uniform(25.0, 90.0)}}}};
}

}  // namespace

std::vector<Recipe> recipes() {
  return {
      {.kind = "static_unbalance", .draw = vector_of("static_unbalance", "offset_m", 1e-6)},
      {.kind = "mass_shift", .draw = mass_shift, .pairs = true},
      {.kind = "battery_discharge",
       .draw = vector_of("battery_discharge", "shift_m_per_Ah", 2e-6),
       .pairs = true},
      {.kind = "elastic_sag", .draw = elastic_sag, .pairs = true},
      {.kind = "bearing_drag", .draw = number_of("bearing_drag", "coefficient_N_m_s", 1e-5)},
      {.kind = "turbine_torque",
       .draw = number_of("turbine_torque", "torque_N_m", 3e-6, true),
       .pairs = true},
      {.kind = "dry_friction", .draw = number_of("dry_friction", "torque_N_m", 3e-6)},
      {.kind = "air_friction", .draw = number_of("air_friction", "coefficient", 3e-5)},
      {.kind = "air_pressure_drag",
       .draw = number_of("air_pressure_drag", "coefficient_N_m_s2", 5e-4),
       .pairs = true},
      {.kind = "room_draft",
       .draw = vector_of("room_draft", "torque_lab_N_m", 5e-6),
       .pairs = true},
      {.kind = "magnetic_dipole",
       .draw = vector_of("magnetic_dipole", "dipole_A_m2", 0.03),
       .pairs = true},
      {.kind = "eddy_damping",
       .draw = number_of("eddy_damping", "coefficient_N_m_s_per_T2", 5e3),
       .pairs = true},
      {.kind = "gravity_gradient", .draw = nothing_of("gravity_gradient")},
      {.kind = "earth_rotation", .draw = nothing_of("earth_rotation")},
      {.kind = "rotor_momentum",
       .draw = vector_of("rotor_momentum", "momentum_N_m_s", 2e-3),
       .pairs = true},
      {.kind = "tether",
       .draw = number_of("tether", "stiffness_N_m_per_rad", 3e-5),
       .needs_small_turns = true},
      {.kind = "floor_vibration", .draw = floor_vibration},
      {.kind = "periodic_torque", .draw = periodic_torque, .pairs = true},
      {.kind = "flexible_mode", .draw = flexible_mode, .most = 6.0, .needs_commands = true},
      {.kind = "actuator_gain",
       .draw = number_of("actuator_gain", "gain_error", 0.1, true),
       .most = 4.0,
       .needs_commands = true,
       .pairs = true},
      {.kind = "inertia_error", .draw = inertia_error, .most = 5.0},
      {.kind = "gravity_tilt", .draw = gravity_tilt},
      {.kind = "attitude_latency",
       .draw = number_of("attitude_latency", "latency_s", 0.05),
       .most = 6.0,
       .pairs = true},
      {.kind = "gyro_bias", .draw = vector_of("gyro_bias", "bias_rad_s", 1e-3)},
      {.kind = "gyro_scale", .draw = vector_of("gyro_scale", "scale", 0.01), .pairs = true},
      {.kind = "gyro_misalignment",
       .draw = vector_of("gyro_misalignment", "misalignment_rad", 0.01),
       .most = 3.0,
       .pairs = true},
      {.kind = "camera_misalignment",
       .draw = vector_of("camera_misalignment", "misalignment_rad", 0.01),
       .most = 3.0},
      {.kind = "heading_cogging",
       .draw = heading_cogging,
       .outside = true,
       .depends_on = "heading"},
      {.kind = "tilt_cubed",
       .draw = number_of("tilt_cubed", "coefficient_N_m", 0.01),
       .most = 100.0,
       .outside = true,
       .depends_on = "tilt"},
      {.kind = "slow_random_torque",
       .draw = slow_random_torque,
       .outside = true,
       .depends_on = "time"},
      {.kind = "exponential_decay",
       .draw = exponential_decay,
       .outside = true,
       .depends_on = "time"},
      {.kind = "pulsed_torque", .draw = pulsed_torque, .outside = true, .depends_on = "time"},
  };
}

}  // namespace photorque::injected
