#include "tools/proof/laws.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/random.h"

namespace photorque::injected {
namespace {

Triple triple(const Numbers& p, size_t first = 0) {
  return {p[first], p[first + 1], p[first + 2]};
}

// The torque of a centre of mass at `offset`.
Triple weight(const Surroundings& s, const Triple& offset) {
  return times(s.mass_kg, cross(offset, s.gravity));
}

Triple static_unbalance(const Numbers& p, const Surroundings& s) {
  return weight(s, triple(p));
}

Triple mass_shift(const Numbers& p, const Surroundings& s) {
  return s.time_s >= p[0] ? weight(s, triple(p, 1)) : Triple{};
}

Triple battery_discharge(const Numbers& p, const Surroundings& s) {
  return weight(s, times(s.charge_Ah, triple(p)));
}

Triple elastic_sag(const Numbers& p, const Surroundings& s) {
  return weight(s, by_component(triple(p), minus(s.gravity, s.gravity_level)));
}

Triple bearing_drag(const Numbers& p, const Surroundings& s) {
  return times(-p[0], s.rate);
}

Triple turbine_torque(const Numbers& p, const Surroundings& s) {
  return times(p[0], s.up);
}

Triple dry_friction(const Numbers& p, const Surroundings& s) {
  const double rate = length(s.rate);
  return rate > 0.0 ? times(-p[0] / rate, s.rate) : Triple{};
}

Triple air_friction(const Numbers& p, const Surroundings& s) {
  return times(-p[0] * std::sqrt(length(s.rate)), s.rate);
}

Triple air_pressure_drag(const Numbers& p, const Surroundings& s) {
  return times(-p[0] * length(s.rate), s.rate);
}

Triple room_draft(const Numbers& p, const Surroundings& s) {
  return to_body(s.attitude, triple(p));
}

Triple magnetic_dipole(const Numbers& p, const Surroundings& s) {
  return cross(triple(p), s.field);
}

Triple eddy_damping(const Numbers& p, const Surroundings& s) {
  return times(p[0], cross(cross(s.rate, s.field), s.field));
}

Triple gravity_gradient(const Numbers&, const Surroundings& s) {
  constexpr double earth_radius = 6.3710087714e6;
  return times(3.0 * s.gravity_m_s2 / earth_radius, cross(s.up, times(s.inertia, s.up)));
}

Triple rotor_momentum(const Numbers& p, const Surroundings& s) {
  return cross(triple(p), s.rate);
}

Triple tether(const Numbers& p, const Surroundings& s) {
  return times(-p[0], turn_of(s.attitude));
}

Triple floor_vibration(const Numbers& p, const Surroundings& s) {
  const double bounce = std::sin(2.0 * pi * p[3] * s.time_s + p[4]);
  return times(-s.mass_kg * bounce, cross(s.offset_m, to_body(s.attitude, triple(p))));
}

Triple periodic_torque(const Numbers& p, const Surroundings& s) {
  return times(std::sin(2.0 * pi * p[3] * s.time_s + p[4]), triple(p));
}

Triple actuator_gain(const Numbers& p, const Surroundings& s) {
  return times(p[0], s.command_N_m);
}

double heading(const Surroundings& s) {
  const auto& [w, x, y, z] = s.attitude;
  return std::atan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z));
}

Triple heading_cogging(const Numbers& p, const Surroundings& s) {
  return times(p[0] * std::sin(p[1] * heading(s) + p[2]), s.up);
}

Triple tilt_cubed(const Numbers& p, const Surroundings& s) {
  const Triple across = cross(s.up, {0, 0, 1});  // from the vertical to body z
  const double sine = length(across), tilt = std::atan2(sine, s.up[2]);
  return sine > 0.0 ? times(-p[0] * tilt * tilt * tilt / sine, across) : Triple{};
}

// Forty tones whose power falls as that of a Gauss–Markov process: smooth, so that any integrator
// may follow, and never the same twice.
Triple slow_random_torque(const Numbers& p, const Surroundings& s) {
  constexpr int tones = 40;
  Triple sum = {};
  double power = 0.0;
  for (int i = 0; i < tones; ++i) {
    const double angular_frequency = (0.04 + 0.24 * i) / p[3];
    const double density = 1.0 / (1.0 + std::pow(angular_frequency * p[3], 2));
    power += 0.5 * density;
    for (size_t k = 0; k < 3; ++k) {
      const double phase =
          2.0 * pi * unit_interval(hash_words(static_cast<uint64_t>(p[4]), 77, i, k));
      sum[k] += std::sqrt(density) * std::sin(angular_frequency * s.time_s + phase);
    }
  }
  return to_body(s.attitude, times(1.0 / std::sqrt(power), by_component(triple(p), sum)));
}

Triple exponential_decay(const Numbers& p, const Surroundings& s) {
  return times(std::exp(-s.time_s / p[3]), triple(p));
}

Triple pulsed_torque(const Numbers& p, const Surroundings& s) {
  const double phase = s.time_s / p[3] - std::floor(s.time_s / p[3]);
  return phase < 1.0 / 3.0 ? triple(p) : Triple{};
}

}  // namespace

const std::vector<LawEntry>& laws() {
  static const std::vector<LawEntry> all = {
      {"static_unbalance", {"offset_m"}, static_unbalance},
      {"mass_shift", {"time_s", "offset_m"}, mass_shift},
      {"battery_discharge", {"shift_m_per_Ah"}, battery_discharge},
      {"elastic_sag", {"compliance_s2"}, elastic_sag},
      {"bearing_drag", {"coefficient_N_m_s"}, bearing_drag},
      {"turbine_torque", {"torque_N_m"}, turbine_torque},
      {"dry_friction", {"torque_N_m"}, dry_friction},
      {"air_friction", {"coefficient"}, air_friction},
      {"air_pressure_drag", {"coefficient_N_m_s2"}, air_pressure_drag},
      {"room_draft", {"torque_lab_N_m"}, room_draft},
      {"magnetic_dipole", {"dipole_A_m2"}, magnetic_dipole},
      {"eddy_damping", {"coefficient_N_m_s_per_T2"}, eddy_damping},
      {"gravity_gradient", {}, gravity_gradient},
      {"earth_rotation", {}, nullptr},
      {"rotor_momentum", {"momentum_N_m_s"}, rotor_momentum},
      {"tether", {"stiffness_N_m_per_rad"}, tether},
      {"floor_vibration", {"acceleration_m_s2", "frequency_Hz", "phase"}, floor_vibration},
      {"periodic_torque", {"torque_N_m", "frequency_Hz", "phase"}, periodic_torque},
      {"flexible_mode", {"axis", "frequency_Hz", "damping", "inertia_kg_m2"}, nullptr},
      {"actuator_gain", {"gain_error"}, actuator_gain},
      {"inertia_error", {"delta_kg_m2"}, nullptr},
      {"gravity_tilt", {"tilt_rad"}, nullptr},
      {"attitude_latency", {"latency_s"}, nullptr},
      {"gyro_bias", {"bias_rad_s"}, nullptr},
      {"gyro_scale", {"scale"}, nullptr},
      {"gyro_misalignment", {"misalignment_rad"}, nullptr},
      {"camera_misalignment", {"misalignment_rad"}, nullptr},
      {"heading_cogging", {"torque_N_m", "periods", "phase"}, heading_cogging, false},
      {"tilt_cubed", {"coefficient_N_m"}, tilt_cubed, false},
      {"slow_random_torque", {"torque_N_m", "time_s", "seed"}, slow_random_torque, false},
      {"exponential_decay", {"torque_N_m", "time_s"}, exponential_decay, false},
      {"pulsed_torque", {"torque_N_m", "period_s"}, pulsed_torque, false},
  };
  return all;
}

const LawEntry& law_of(const std::string& kind) {
  const auto found =
      std::ranges::find_if(laws(), [&](const LawEntry& law) { return law.kind == kind; });
  if (found == laws().end()) throw NumericalError("no injected law is called " + kind);
  return *found;
}

Numbers numbers_of(const InjectedEffect& effect) {
  Numbers numbers;
  for (const std::string& key : law_of(effect.kind).keys) {
    const auto found = effect.parameters.find(key);
    if (found == effect.parameters.end()) {
      throw NumericalError("the injected " + effect.kind + " has no " + key);
    }
    numbers.insert(numbers.end(), found->second.begin(), found->second.end());
  }
  return numbers;
}

}  // namespace photorque::injected
