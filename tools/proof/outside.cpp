#include "tools/proof/outside.h"

#include <cmath>

#include "core/constants.h"
#include "core/numerics/random.h"

namespace photorque::injected {
namespace {

double heading(const Surroundings& s) {
  const auto& [w, x, y, z] = s.attitude;
  return std::atan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z));
}

PlainTorque heading_cogging(const InjectedEffect& effect) {
  return [size_N_m = effect.number("torque_N_m"), periods = effect.number("periods"),
          phase = effect.number("phase")](const Surroundings& s) {
    return times(size_N_m * std::sin(periods * heading(s) + phase), s.up);
  };
}

PlainTorque tilt_cubed(const InjectedEffect& effect) {
  return [size_N_m = effect.number("coefficient_N_m")](const Surroundings& s) {
    const Triple across = cross(s.up, {0, 0, 1});  // from the vertical to body z
    const double sine = length(across), tilt = std::atan2(sine, s.up[2]);
    return sine > 0.0 ? times(-size_N_m * tilt * tilt * tilt / sine, across) : Triple{};
  };
}

// Forty tones whose power falls as that of a Gauss–Markov process: smooth, so that any integrator
// may follow, and never the same twice.
PlainTorque slow_random_torque(const InjectedEffect& effect) {
  return [size_N_m = effect.triple("torque_N_m"), time_s = effect.number("time_s"),
          seed = static_cast<uint64_t>(effect.number("seed"))](const Surroundings& s) {
    constexpr int tones = 40;
    Triple sum = {};
    double power = 0.0;
    for (int i = 0; i < tones; ++i) {
      const double angular_frequency = (0.04 + 0.24 * i) / time_s;
      const double density = 1.0 / (1.0 + std::pow(angular_frequency * time_s, 2));
      power += 0.5 * density;
      for (size_t k = 0; k < 3; ++k) {
        const double phase = 2.0 * pi * unit_interval(hash_words(seed, 77, i, k));
        sum[k] += std::sqrt(density) * std::sin(angular_frequency * s.time_s + phase);
      }
    }
    return to_body(s.attitude, times(1.0 / std::sqrt(power), by_component(size_N_m, sum)));
  };
}

PlainTorque exponential_decay(const InjectedEffect& effect) {
  return [size_N_m = effect.triple("torque_N_m"), time_s = effect.number("time_s")](
             const Surroundings& s) { return times(std::exp(-s.time_s / time_s), size_N_m); };
}

PlainTorque pulsed_torque(const InjectedEffect& effect) {
  return [size_N_m = effect.triple("torque_N_m"),
          period_s = effect.number("period_s")](const Surroundings& s) {
    const double phase = s.time_s / period_s - std::floor(s.time_s / period_s);
    return phase < 1.0 / 3.0 ? size_N_m : Triple{};
  };
}

std::vector<double> pulse_edges_s(const InjectedEffect& effect, double from_s, double to_s) {
  std::vector<double> all;
  const double period_s = effect.number("period_s");
  for (double t = std::floor(from_s / period_s) * period_s; t < to_s; t += period_s) {
    all.push_back(t);
    all.push_back(t + period_s / 3.0);
  }
  return all;
}

EffectNumbers draw_cogging(RandomDraw& draw, const ExampleConditions&) {
  return {{"torque_N_m", {5e-6}},
          {"periods", {static_cast<double>(2 + draw.below(4))}},
          {"phase", {draw.uniform(-3.1, 3.1)}}};
}

EffectNumbers draw_random_torque(RandomDraw& draw, const ExampleConditions&) {
  return {{"torque_N_m", list(times(3e-6, {draw.uniform(0, 1), draw.uniform(0, 1), 1.0}))},
          {"time_s", {draw.log_uniform(15.0, 50.0)}},
          {"seed", {std::floor(draw.uniform(1, 1e6))}}};
}

EffectNumbers draw_decay(RandomDraw& draw, const ExampleConditions&) {
  return {{"torque_N_m", list(times(5e-6, draw.direction()))},
          {"time_s", {draw.log_uniform(20.0, 120.0)}}};
}

EffectNumbers draw_pulses(RandomDraw& draw, const ExampleConditions&) {
  return {{"torque_N_m", list(times(5e-6, draw.direction()))},
          {"period_s", {draw.uniform(25.0, 90.0)}}};
}

}  // namespace

std::vector<OutsideLaw> outside_laws() {
  return {
      {"heading_cogging",
       "heading",
       {.draw = draw_cogging, .torque = heading_cogging, .strength = "torque_N_m"}},
      {"tilt_cubed",
       "tilt",
       {.draw = fixed_size("coefficient_N_m", 0.01),
        .torque = tilt_cubed,
        .strength = "coefficient_N_m",
        .max_factor = 100.0}},
      {"slow_random_torque",
       "time",
       {.draw = draw_random_torque, .torque = slow_random_torque, .strength = "torque_N_m"}},
      {"exponential_decay",
       "time",
       {.draw = draw_decay, .torque = exponential_decay, .strength = "torque_N_m"}},
      {"pulsed_torque",
       "time",
       {.draw = draw_pulses,
        .torque = pulsed_torque,
        .jumps_s = pulse_edges_s,
        .strength = "torque_N_m"}},
  };
}

}  // namespace photorque::injected
