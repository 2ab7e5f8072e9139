#include "tools/proof/motion.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "tools/proof/recipes.h"

namespace photorque {
namespace {

using namespace injected;

constexpr size_t state_size = 10;  // attitude 4, rate 3, charge [Ah], appendage's angle and rate
using State = std::array<double, state_size>;

// The platform, its laboratory and its instruments as the effects change them.
PlainPlatform changed(const InjectedWorld& world) {
  PlainPlatform platform{.inertia = world.inertia_kg_m2,
                         .gravity_lab = {0, 0, -world.gravity_m_s2},
                         .latitude_rad = world.latitude_rad};
  for (const InjectedEffect& effect : world.effects) {
    const Injection& law = recipe_of(effect.kind).injection;
    if (law.alter != nullptr) law.alter(effect, platform);
  }
  return platform;
}

// Times a lab vector: the vector in body axes.
Matrix lab_axes(const Quaternion& q) {
  const auto& [w, x, y, z] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
           {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
           {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
}

class Equations {
 public:
  explicit Equations(const InjectedWorld& world) : world_(world), platform_(changed(world)) {
    const Recipe &drag = recipe_of(nominal_drag), &unbalance = recipe_of(nominal_unbalance);
    add({drag.kind, {{drag.injection.strength, {world.drag_N_m_s}}}});
    add({unbalance.kind, {{unbalance.injection.strength, list(world.offset_m)}}});
    for (const InjectedEffect& effect : world.effects) add(effect);
    own_inertia_ = platform_.inertia;
    if (const std::optional<Appendage>& appendage = platform_.appendage) {
      const Triple& a = appendage->axis;
      for (size_t i = 0; i < 3; ++i) {
        own_inertia_[i] = minus(own_inertia_[i], times(appendage->inertia_kg_m2 * a[i], a));
      }
    }
    inverse_ = inverse(own_inertia_);
  }

  State begin(const InjectedStart& start) const {
    State y = {};
    std::copy(start.attitude.begin(), start.attitude.end(), y.begin());
    std::copy(start.rate_rad_s.begin(), start.rate_rad_s.end(), y.begin() + 4);
    if (platform_.appendage) y[9] = dot(platform_.appendage->axis, start.rate_rad_s);
    return y;
  }

  State rates(double time_s, const State& y, const InjectedCommand& command) const {
    const Surroundings now = surroundings(time_s, y, command);
    Triple torque = command.torque_N_m;
    for (const PlainTorque& acting : acting_) torque = plus(torque, acting(now));
    const Quaternion spin = product(now.attitude, {0, now.rate[0], now.rate[1], now.rate[2]});
    State d = {};
    for (size_t i = 0; i < 4; ++i) d[i] = 0.5 * spin[i];
    d[7] = command.battery_current_A / 3600.0;
    const Triple earth = to_body(now.attitude, platform_.earth_lab);
    const Triple inertial = plus(now.rate, earth);
    Triple momentum = times(own_inertia_, inertial);
    if (platform_.appendage) {
      const Appendage& a = *platform_.appendage;
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
    moment.camera = product(moment.attitude, quaternion_of(platform_.camera_turn));
    moment.rate_rad_s = {y[4], y[5], y[6]};
    const Triple sensed = plus(moment.rate_rad_s, to_body(moment.attitude, platform_.earth_lab));
    moment.gyro_rad_s = plus(plus(sensed, by_component(platform_.gyro_scale, sensed)),
                             plus(cross(platform_.gyro_turn, sensed),
                                  plus(world_.gyro_bias_rad_s, platform_.gyro_bias)));
    return moment;
  }

  // Jumps of the laws after `from_s` and before `to_s`.
  std::vector<double> jumps(double from_s, double to_s) const {
    std::vector<double> all;
    for (const InjectedEffect& effect : world_.effects) {
      const Injection& law = recipe_of(effect.kind).injection;
      if (law.jumps_s == nullptr) continue;
      for (const double t : law.jumps_s(effect, from_s, to_s)) all.push_back(t);
    }
    std::erase_if(all, [&](double t) { return t <= from_s || t >= to_s; });
    return all;
  }

 private:
  void add(const InjectedEffect& effect) {
    const Injection& law = recipe_of(effect.kind).injection;
    if (law.torque != nullptr) acting_.push_back(law.torque(effect));
  }

  Surroundings surroundings(double time_s, const State& y, const InjectedCommand& command) const {
    Surroundings s;
    s.time_s = time_s;
    s.attitude = normalised({y[0], y[1], y[2], y[3]});
    s.rate = {y[4], y[5], y[6]};
    s.charge_Ah = y[7];
    s.mass_kg = world_.mass_kg;
    s.offset_m = world_.offset_m;
    s.inertia = platform_.inertia;
    const Matrix lab = lab_axes(s.attitude);
    s.gravity = times(lab, platform_.gravity_lab);
    s.gravity_level = platform_.gravity_lab;
    s.gravity_m_s2 = world_.gravity_m_s2;
    s.field = times(lab, world_.magnetic_field_T);
    s.up = {lab[0][2], lab[1][2], lab[2][2]};
    s.command_N_m = command.torque_N_m;
    return s;
  }

  InjectedWorld world_;
  PlainPlatform platform_;
  Matrix own_inertia_ = {}, inverse_ = {};
  std::vector<PlainTorque> acting_;
};

State along(const State& y, double by, const State& d) {
  State sum = y;
  for (size_t i = 0; i < state_size; ++i) sum[i] += by * d[i];
  return sum;
}

// Kutta's classical step. A law that jumps at either end is looked at just inside. The step is
// halved where the rate's change would bend by more than `bend_rad_s` (0: never).
State step(const Equations& equations, const InjectedCommand& command, double t, const State& y,
           double h, double bend_rad_s, int halvings = 12) {
  const double inside = 1e-9 * h;
  const State a = equations.rates(t + inside, y, command);
  const State b = equations.rates(t + 0.5 * h, along(y, 0.5 * h, a), command);
  const State c = equations.rates(t + 0.5 * h, along(y, 0.5 * h, b), command);
  const State d = equations.rates(t + h - inside, along(y, h, c), command);
  if (bend_rad_s > 0.0 && halvings > 0) {
    double bend = 0.0;
    for (size_t i = 4; i < 7; ++i) bend = std::max(bend, std::abs(a[i] - b[i] - c[i] + d[i]));
    if (h / 6.0 * bend > bend_rad_s) {
      const State half = step(equations, command, t, y, 0.5 * h, bend_rad_s, halvings - 1);
      return step(equations, command, t + 0.5 * h, half, 0.5 * h, bend_rad_s, halvings - 1);
    }
  }
  State sum = y;
  for (size_t i = 0; i < state_size; ++i) {
    sum[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
  }
  return sum;
}

}  // namespace

std::vector<std::string> injected_kinds() {
  std::vector<std::string> names;
  for (const Recipe& recipe : recipes()) names.push_back(recipe.kind);
  return names;
}

bool is_outside_catalogue(const std::string& kind) {
  return recipe_of(kind).outside;
}

void scale_effect(InjectedEffect& effect, double by) {
  const auto strength = effect.parameters.find(recipe_of(effect.kind).injection.strength);
  if (strength == effect.parameters.end()) return;
  for (double& number : strength->second) number *= by;
}

double injected_start_s(const InjectedWorld& world) {
  return changed(world).appendage ? 0.0 : -0.5;
}

double injected_latency_s(const InjectedWorld& world) {
  return changed(world).camera_latency_s;
}

std::array<Triple, 3> injected_inertia_kg_m2(const InjectedWorld& world) {
  return changed(world).inertia;
}

std::vector<InjectedContext> injected_motion(const InjectedWorld& world,
                                             const std::vector<InjectedCommand>& commands,
                                             const InjectedStart& start, double from_s,
                                             const std::vector<double>& times_s, double step_s,
                                             double bend_rad_s) {
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
    for (int i = 0; i < steps; ++i) {
      y = step(equations, now, t + i * h, y, h, bend_rad_s);
    }
    t = end_s;
  };
  for (const double time_s : times_s) {
    while (stop < stops.size() && stops[stop] <= time_s) {
      if (stops[stop] > t) advance_to(stops[stop]);
      ++stop;
    }
    if (time_s > t) advance_to(time_s);
    if (!std::isfinite(y[4]))
      throw NumericalError("the motion under the injected effects diverges");
    moments.push_back(equations.read(t, y));
  }
  return moments;
}

}  // namespace photorque
