#include "diagnosis/attitude/catalogue.h"

#include <algorithm>

namespace photorque {
namespace {

constexpr double unbounded = 1e308;

EffectKey number(const std::string& key, double scale) {
  return {key, {0.0}, scale};
}
EffectKey not_negative(const std::string& key, double scale) {
  return {key, {0.0}, scale, 0.0};
}
EffectKey vector(const std::string& key, double scale) {
  return {key, {0.0, 0.0, 0.0}, scale};
}
EffectKey searched(const std::string& key, double start, double scale, double lowest,
                   double highest = unbounded) {
  return {key, {start}, scale, lowest, highest, true};
}

}  // namespace

std::vector<Effect> catalogue(const Platform& platform) {
  const double inertia_kg_m2 = platform.inertia_kg_m2.trace() / 3.0;
  const double phase_scale = 1.8;  // of a uniform angle
  return {
      {"static_unbalance",
       {vector("offset_m", 5e-6)},
       "the centre of mass lies elsewhere than believed, beyond the uncertainty stated"},
      {"mass_shift",
       {searched("time_s", 0.0, 100.0, 0.0), vector("offset_m", 3e-6)},
       "a part of the platform moved at one instant and took the centre of mass with it"},
      {"battery_discharge",
       {vector("shift_m_per_Ah", 3e-6)},
       "the centre of mass moves in proportion to the charge drawn from the battery",
       "charge"},
      {"elastic_sag",
       {vector("compliance_s2", 5e-7)},
       "the structure bends under its weight, differently at every tilt"},
      {"bearing_drag",
       {number("coefficient_N_m_s", 2e-5)},
       "the bearing's viscous drag differs from what is believed, beyond the uncertainty stated"},
      {"turbine_torque",
       {number("torque_N_m", 5e-6)},
       "the bearing's exhaust drives the platform about the vertical with a constant torque"},
      {"dry_friction",
       {not_negative("torque_N_m", 5e-6)},
       "something rubs: a torque of constant size against the motion"},
      {"air_friction",
       {not_negative("coefficient", 5e-5)},
       "laminar boundary layers of the surrounding air brake with the power 1.5 of the rate"},
      {"air_pressure_drag",
       {not_negative("coefficient_N_m_s2", 1e-3)},
       "form drag of the surrounding air brakes with the square of the rate"},
      {"room_draft",
       {vector("torque_lab_N_m", 5e-6)},
       "a steady draught exerts a torque that is constant in the laboratory"},
      {"magnetic_dipole",
       {vector("dipole_A_m2", 0.05)},
       "a residual magnetic dipole of the platform turns towards the ambient field"},
      {"eddy_damping",
       {not_negative("coefficient_N_m_s_per_T2", 2e4)},
       "eddy currents brake rotation across the ambient magnetic field"},
      {"gravity_gradient",
       {},
       "gravity weakens with height and turns the longest axis towards the vertical"},
      {"earth_rotation",
       {},
       "the laboratory turns with the Earth: the platform and the gyro feel it"},
      {"rotor_momentum",
       {vector("momentum_N_m_s", 5e-3)},
       "a spinning part on board couples the axes like a gyroscope"},
      {"tether",
       {not_negative("stiffness_N_m_per_rad", 1e-5)},
       "a cable pulls the platform back to zero attitude"},
      {"floor_vibration",
       {vector("acceleration_m_s2", 0.1), searched("frequency_Hz", 1.0, 5.0, 0.0, 100.0),
        searched("phase", 0.0, phase_scale, -unbounded)},
       "the floor shakes the bearing under a centre of mass that is off"},
      {"periodic_torque",
       {vector("torque_N_m", 5e-5), searched("frequency_Hz", 1.0, 5.0, 0.0, 100.0),
        searched("phase", 0.0, phase_scale, -unbounded)},
       "something on board shakes the platform at one frequency"},
      {"flexible_mode",
       {{"axis", {0.0, 0.0, 1.0}, 0.6, -unbounded, unbounded, true},
        searched("frequency_Hz", 0.5, 1.0, 1e-3, 100.0),
        {"damping", {0.02}, 0.05, 0.0, 2.0, true},
        {"inertia_kg_m2", {0.01 * inertia_kg_m2}, 0.05 * inertia_kg_m2, 0.0, unbounded, true}},
       "an appendage or a liquid swings against the body"},
      {"actuator_gain",
       {number("gain_error", 0.2)},
       "the actuators give more or less torque than commanded",
       "command"},
      {"actuator_gain",
       {vector("gain_error", 0.2)},
       "the actuators give more or less torque than commanded, each axis its own",
       "command"},
      {"inertia_error",
       {{"delta_kg_m2", {0, 0, 0, 0, 0, 0}, 0.03 * inertia_kg_m2}},
       "the moments or products of inertia differ from those believed"},
      {"gravity_tilt",
       {{"tilt_rad", {0.0, 0.0}, 5e-3}},
       "gravity does not point along the camera's vertical: the camera is not level"},
      {"attitude_latency",
       {{"latency_s", {0.0}, 0.1, 0.0}},
       "the camera reports an attitude that is already past"},
      {"gyro_bias",
       {vector("bias_rad_s", 5e-3)},
       "the gyro reads a constant rate at rest, beyond the uncertainty stated"},
      {"gyro_scale",
       {vector("scale", 0.02)},
       "the gyro's axes read too much or too little in proportion to the rate"},
      {"gyro_misalignment",
       {vector("misalignment_rad", 0.01)},
       "the gyro is mounted at a small angle to the body axes"},
      {"camera_misalignment",
       {vector("misalignment_rad", 5e-3)},
       "the camera's target is mounted at a small angle to the body axes"},
  };
}

Disturbance disturbance_of(const Effect& effect, const DisturbanceContext& context) {
  std::vector<std::pair<std::string, std::vector<double>>> values;
  for (const EffectKey& key : effect.keys) values.emplace_back(key.key, key.start);
  return make_disturbance_of(effect.kind, values, context);
}

const EffectKey& key_of(const Effect& effect, const Parameter& parameter) {
  return *std::find_if(effect.keys.begin(), effect.keys.end(),
                       [&](const EffectKey& key) { return key.key == parameter.key; });
}

}  // namespace photorque
