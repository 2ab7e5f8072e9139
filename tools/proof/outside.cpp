#include "tools/proof/outside.h"

#include <algorithm>
#include <array>
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

// Forty tones whose power falls as that of a Gauss–Markov process: smooth, so that any integrator
// may follow, and never the same twice.
class SlowRandomTorque {
 public:
  explicit SlowRandomTorque(const InjectedEffect& effect) : time_s_(effect.number("time_s")) {
    const auto seed = static_cast<uint64_t>(effect.number("seed"));
    const Triple size_N_m = effect.triple("torque_N_m");
    double power = 0.0;
    for (size_t i = 0; i < tones; ++i) power += 0.5 * density(i);
    for (size_t i = 0; i < tones; ++i) {
      for (size_t k = 0; k < 3; ++k) {
        const double phase = 2.0 * pi * unit_interval(hash_words(seed, 77, i, k));
        const double amplitude = size_N_m[k] * std::sqrt(density(i) / power);
        sine_[i][k] = amplitude * std::cos(phase);
        cosine_[i][k] = amplitude * std::sin(phase);
      }
    }
  }

  Triple operator()(const Surroundings& s) const {
    // The frequencies stand at equal distances: each turns by the same angle more.
    const double first = lowest * s.time_s / time_s_, next = spacing * s.time_s / time_s_;
    const double sine_next = std::sin(next), cosine_next = std::cos(next);
    double sine = std::sin(first), cosine = std::cos(first);
    Triple sum = {};
    for (size_t i = 0; i < tones; ++i) {
      sum = plus(sum, plus(times(sine, sine_[i]), times(cosine, cosine_[i])));
      const double turned = sine * cosine_next + cosine * sine_next;
      cosine = cosine * cosine_next - sine * sine_next;
      sine = turned;
    }
    return to_body(s.attitude, sum);
  }

 private:
  static constexpr size_t tones = 40;
  static constexpr double lowest = 0.04, spacing = 0.24;  // angular frequencies times time_s
  static double density(size_t i) {
    return 1.0 / (1.0 + std::pow(lowest + spacing * static_cast<double>(i), 2));
  }

  double time_s_;
  std::array<Triple, tones> sine_ = {}, cosine_ = {};
};

PlainTorque slow_random_torque(const InjectedEffect& effect) {
  return SlowRandomTorque(effect);
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

// From the vertical to body z, and by how much.
struct Tilt {
  Triple axis = {};
  double angle = 0.0;
};
Tilt tilt_of(const Surroundings& s) {
  const Triple across = cross(s.up, {0, 0, 1});
  const double sine = length(across);
  return {sine > 0.0 ? times(1.0 / sine, across) : Triple{}, std::atan2(sine, s.up[2])};
}

PlainTorque tilt_cubed(const InjectedEffect& effect) {
  return [size_N_m = effect.number("coefficient_N_m")](const Surroundings& s) {
    const Tilt tilt = tilt_of(s);
    return times(-size_N_m * tilt.angle * tilt.angle * tilt.angle, tilt.axis);
  };
}

PlainTorque edge_drag(const InjectedEffect& effect) {
  return [size_N_m_s = effect.number("coefficient_N_m_s")](const Surroundings& s) {
    constexpr double common_rad = 0.1;
    const double part = tilt_of(s).angle / common_rad;
    return times(-size_N_m_s * part * part, s.rate);
  };
}

PlainTorque rough_pad(const InjectedEffect& effect) {
  return [size_N_m_s = effect.number("coefficient_N_m_s"), at = effect.number("heading_rad"),
          width = effect.number("width_rad")](const Surroundings& s) {
    // Smooth all around, near a bell of that width.
    const double here = std::exp((std::cos(heading(s) - at) - 1.0) / (width * width));
    return times(-size_N_m_s * here * dot(s.rate, s.up), s.up);
  };
}

PlainTorque slack_cable(const InjectedEffect& effect) {
  return [stiffness = effect.number("stiffness_N_m_per_rad"),
          free = effect.number("free_rad")](const Surroundings& s) {
    const Tilt tilt = tilt_of(s);
    return times(-stiffness * std::max(0.0, tilt.angle - free), tilt.axis);
  };
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

EffectNumbers draw_pad(RandomDraw& draw, const ExampleConditions&) {
  return {{"coefficient_N_m_s", {2e-5}},
          {"heading_rad", {draw.uniform(-3.1, 3.1)}},
          {"width_rad", {draw.uniform(0.3, 0.8)}}};
}

EffectNumbers draw_cable(RandomDraw& draw, const ExampleConditions&) {
  return {{"stiffness_N_m_per_rad", {1e-4}}, {"free_rad", {draw.uniform(0.03, 0.12)}}};
}

}  // namespace

std::vector<OutsideLaw> outside_laws() {
  return {
      {"heading_cogging",
       {"heading"},
       {.draw = draw_cogging, .torque = heading_cogging, .strength = "torque_N_m"}},
      {"tilt_cubed",
       {"tilt"},
       {.draw = fixed_size("coefficient_N_m", 0.01),
        .torque = tilt_cubed,
        .strength = "coefficient_N_m",
        .max_factor = 100.0}},
      {"slow_random_torque",
       {"time"},
       {.draw = draw_random_torque, .torque = slow_random_torque, .strength = "torque_N_m"}},
      {"exponential_decay",
       {"time"},
       {.draw = draw_decay, .torque = exponential_decay, .strength = "torque_N_m"}},
      {"pulsed_torque",
       {"time"},
       {.draw = draw_pulses,
        .torque = pulsed_torque,
        .jumps_s = pulse_edges_s,
        .strength = "torque_N_m"}},
      {"edge_drag",
       {"tilt", "rate"},
       {.draw = fixed_size("coefficient_N_m_s", 1e-5),
        .torque = edge_drag,
        .strength = "coefficient_N_m_s",
        .max_factor = 100.0}},
      {"rough_pad",
       {"heading", "rate"},
       {.draw = draw_pad,
        .torque = rough_pad,
        .strength = "coefficient_N_m_s",
        .max_factor = 100.0}},
      {"slack_cable",
       {"tilt"},
       {.draw = draw_cable,
        .torque = slack_cable,
        .strength = "stiffness_N_m_per_rad",
        .max_factor = 100.0}},
  };
}

}  // namespace photorque::injected
