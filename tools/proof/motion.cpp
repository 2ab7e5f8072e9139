#include "tools/proof/motion.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/constants.h"
#include "core/errors.h"
#include "tools/proof/laws.h"

namespace photorque {
namespace {

using namespace injected;

constexpr double earth_rate_1_s = 7.292115e-5;
constexpr size_t state_size = 10;  // attitude 4, rate 3, charge [Ah], appendage's angle and rate
using State = std::array<double, state_size>;

struct Acting {
  Numbers numbers;
  TorqueFunction torque;
};

// An appendage on a spring: angle beside the body, and its absolute rate.
struct Appendage {
  Triple axis = {};
  double angular_frequency_1_s = 0.0, damping = 0.0, inertia_kg_m2 = 0.0;
};

class Equations {
 public:
  explicit Equations(const InjectedWorld& world) : world_(world), inertia_(world.inertia_kg_m2) {
    gravity_lab_ = {0, 0, -world.gravity_m_s2};
    acting_.push_back({{world.drag_N_m_s}, law_of("bearing_drag").torque});
    acting_.push_back({numbers_of({"static_unbalance",
                                   {{"offset_m", {world.offset_m.begin(), world.offset_m.end()}}}}),
                       law_of("static_unbalance").torque});
    for (const InjectedEffect& effect : world.effects) add(effect);
    own_inertia_ = inertia_;
    if (appendage_) {
      const Triple& a = appendage_->axis;
      for (size_t i = 0; i < 3; ++i) {
        own_inertia_[i] = minus(own_inertia_[i], times(appendage_->inertia_kg_m2 * a[i], a));
      }
    }
    inverse_ = inverse(own_inertia_);
  }

  State begin(const InjectedStart& start) const {
    State y = {};
    std::copy(start.attitude.begin(), start.attitude.end(), y.begin());
    std::copy(start.rate_rad_s.begin(), start.rate_rad_s.end(), y.begin() + 4);
    if (appendage_) y[9] = dot(appendage_->axis, start.rate_rad_s);
    return y;
  }

  State rates(double time_s, const State& y, const InjectedCommand& command) const {
    const Surroundings now = surroundings(time_s, y, command);
    Triple torque = command.torque_N_m;
    for (const Acting& a : acting_) torque = plus(torque, a.torque(a.numbers, now));
    const Quaternion spin = product(now.attitude, {0, now.rate[0], now.rate[1], now.rate[2]});
    State d = {};
    for (size_t i = 0; i < 4; ++i) d[i] = 0.5 * spin[i];
    d[7] = command.battery_current_A / 3600.0;
    const Triple earth = to_body(now.attitude, earth_lab_);
    const Triple inertial = plus(now.rate, earth);
    Triple momentum = times(own_inertia_, inertial);
    if (appendage_) {
      const Appendage& a = *appendage_;
      d[8] = y[9] - dot(a.axis, now.rate);
      const double pull =
          a.angular_frequency_1_s * (a.angular_frequency_1_s * y[8] + 2.0 * a.damping * d[8]);
      d[9] = -pull;
      torque = plus(torque, times(a.inertia_kg_m2 * pull, a.axis));
      momentum = plus(momentum, times(a.inertia_kg_m2 * y[9], a.axis));
    }
    // Of the inertial rate; that of the Earth's rate as the body sees it comes off again.
    const Triple acceleration =
        plus(times(inverse_, minus(torque, cross(inertial, momentum))), cross(now.rate, earth));
    std::copy(acceleration.begin(), acceleration.end(), d.begin() + 4);
    return d;
  }

  // What the instruments read in a state.
  InjectedContext read(double time_s, const State& y) const {
    InjectedContext moment;
    moment.time_s = time_s;
    moment.attitude = normalised({y[0], y[1], y[2], y[3]});
    moment.camera = product(moment.attitude, quaternion_of(camera_turn_));
    moment.rate_rad_s = {y[4], y[5], y[6]};
    const Triple sensed = plus(moment.rate_rad_s, to_body(moment.attitude, earth_lab_));
    moment.gyro_rad_s = plus(plus(sensed, by_component(gyro_scale_, sensed)),
                             plus(cross(gyro_turn_, sensed), plus(world_.gyro_bias_rad_s, bias_)));
    return moment;
  }

  // Jumps of the laws after `from_s` and before `to_s`.
  std::vector<double> jumps(double from_s, double to_s) const {
    std::vector<double> all;
    for (const InjectedEffect& effect : world_.effects) {
      if (effect.kind == "mass_shift") all.push_back(effect.parameters.at("time_s")[0]);
      if (effect.kind != "pulsed_torque") continue;
      const double period_s = effect.parameters.at("period_s")[0];
      for (double t = std::floor(from_s / period_s) * period_s; t < to_s; t += period_s) {
        all.push_back(t);
        all.push_back(t + period_s / 3.0);
      }
    }
    std::erase_if(all, [&](double t) { return t <= from_s || t >= to_s; });
    return all;
  }

 private:
  void add(const InjectedEffect& effect) {
    const LawEntry& law = law_of(effect.kind);
    const Numbers p = numbers_of(effect);
    if (law.torque != nullptr) acting_.push_back({p, law.torque});
    const auto vector = [&] { return Triple{p[0], p[1], p[2]}; };
    if (effect.kind == "earth_rotation") {
      earth_lab_ = {0.0, earth_rate_1_s * std::cos(world_.latitude_rad),
                    earth_rate_1_s * std::sin(world_.latitude_rad)};
    } else if (effect.kind == "inertia_error") {
      const Matrix delta = {{{p[0], p[3], p[4]}, {p[3], p[1], p[5]}, {p[4], p[5], p[2]}}};
      for (size_t i = 0; i < 3; ++i) inertia_[i] = plus(inertia_[i], delta[i]);
    } else if (effect.kind == "gravity_tilt") {
      const Quaternion turn = quaternion_of({p[0], p[1], 0.0});
      gravity_lab_ = to_body(conjugate(turn), gravity_lab_);
    } else if (effect.kind == "flexible_mode") {
      appendage_ = Appendage{times(1.0 / length(vector()), vector()), 2.0 * pi * p[3], p[4], p[5]};
    } else if (effect.kind == "gyro_bias") {
      bias_ = vector();
    } else if (effect.kind == "gyro_scale") {
      gyro_scale_ = vector();
    } else if (effect.kind == "gyro_misalignment") {
      gyro_turn_ = vector();
    } else if (effect.kind == "camera_misalignment") {
      camera_turn_ = vector();
    }
  }

  Surroundings surroundings(double time_s, const State& y, const InjectedCommand& command) const {
    Surroundings s;
    s.time_s = time_s;
    s.attitude = normalised({y[0], y[1], y[2], y[3]});
    s.rate = {y[4], y[5], y[6]};
    s.charge_Ah = y[7];
    s.mass_kg = world_.mass_kg;
    s.offset_m = world_.offset_m;
    s.inertia = inertia_;
    s.gravity = to_body(s.attitude, gravity_lab_);
    s.gravity_level = gravity_lab_;
    s.gravity_m_s2 = world_.gravity_m_s2;
    s.field = to_body(s.attitude, world_.magnetic_field_T);
    s.up = to_body(s.attitude, times(-1.0 / world_.gravity_m_s2, gravity_lab_));
    s.command_N_m = command.torque_N_m;
    return s;
  }

  InjectedWorld world_;
  Matrix inertia_, own_inertia_ = {}, inverse_ = {};
  Triple gravity_lab_ = {}, earth_lab_ = {};
  Triple bias_ = {}, gyro_scale_ = {}, gyro_turn_ = {}, camera_turn_ = {};
  std::optional<Appendage> appendage_;
  std::vector<Acting> acting_;
};

State along(const State& y, double by, const State& d) {
  State sum = y;
  for (size_t i = 0; i < state_size; ++i) sum[i] += by * d[i];
  return sum;
}

// Kutta's classical step. A law that jumps at either end is looked at just inside.
State step(const Equations& equations, const InjectedCommand& command, double t, const State& y,
           double h) {
  const double inside = 1e-9 * h;
  const State a = equations.rates(t + inside, y, command);
  const State b = equations.rates(t + 0.5 * h, along(y, 0.5 * h, a), command);
  const State c = equations.rates(t + 0.5 * h, along(y, 0.5 * h, b), command);
  const State d = equations.rates(t + h - inside, along(y, h, c), command);
  State sum = y;
  for (size_t i = 0; i < state_size; ++i) {
    sum[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
  }
  return sum;
}

}  // namespace

std::vector<std::string> injected_kinds() {
  std::vector<std::string> names;
  for (const LawEntry& law : laws()) names.push_back(law.kind);
  return names;
}

bool is_outside_catalogue(const std::string& kind) {
  return !law_of(kind).in_catalogue;
}

void scale_effect(InjectedEffect& effect, double by) {
  static const std::set<std::string> shape = {"time_s", "frequency_Hz", "phase",    "damping",
                                              "axis",   "periods",      "period_s", "seed"};
  for (auto& [key, numbers] : effect.parameters) {
    if (shape.contains(key)) continue;
    for (double& number : numbers) number *= by;
  }
}

double injected_latency_s(const InjectedWorld& world) {
  for (const InjectedEffect& effect : world.effects) {
    if (effect.kind == "attitude_latency") return effect.parameters.at("latency_s")[0];
  }
  return 0.0;
}

std::vector<InjectedContext> injected_motion(const InjectedWorld& world,
                                             const std::vector<InjectedCommand>& commands,
                                             const InjectedStart& start, double from_s,
                                             const std::vector<double>& times_s, double step_s) {
  const Equations equations(world);
  std::vector<InjectedContext> moments;
  if (times_s.empty()) return moments;
  std::vector<double> stops = equations.jumps(from_s, times_s.back());
  for (const InjectedCommand& c : commands) stops.push_back(c.time_s);
  std::ranges::sort(stops);

  State y = equations.begin(start);
  double t = from_s;
  size_t stop = 0, held = 0;
  const auto advance_to = [&](double end_s) {
    const auto steps = static_cast<int>(std::ceil((end_s - t) / step_s - 1e-9));
    const double h = steps > 0 ? (end_s - t) / steps : 0.0;
    while (held + 1 < commands.size() && commands[held + 1].time_s <= t + 1e-12) ++held;
    const bool before = commands.empty() || commands[held].time_s > t + 1e-12;
    const InjectedCommand now = before ? InjectedCommand{} : commands[held];
    for (int i = 0; i < steps; ++i) y = step(equations, now, t + i * h, y, h);
    t = end_s;
  };
  for (const double time_s : times_s) {
    while (stop < stops.size() && stops[stop] <= time_s) {
      if (stops[stop] > t) advance_to(stops[stop]);
      ++stop;
    }
    if (time_s > t) advance_to(time_s);
    if (!std::isfinite(y[4])) throw NumericalError("the motion under the injected effects diverges");
    moments.push_back(equations.read(t, y));
  }
  return moments;
}

}  // namespace photorque
