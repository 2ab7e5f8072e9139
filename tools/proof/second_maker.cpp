// Platforms and motions unlike those of the first maker: see plan.h.
#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "tools/proof/plan.h"

namespace photorque::injected {
namespace {

enum class Motion { spin, tumble, swing, rest };

struct Setting {
  Motion motion = Motion::swing;
  bool has_gravity = true;
  double swing_rad_s = 0.0;  // of the pendulum about its level axes
};

bool any(const std::vector<Recipe>& recipes, bool (*member)(const Recipe&)) {
  return std::ranges::any_of(recipes, member);
}

Setting draw_motion(RandomDraw& draw, InjectedCase& c, const std::vector<Recipe>& recipes) {
  // What pulls back to zero attitude jumps at half a turn.
  const bool still = any(recipes, [](const Recipe& r) { return r.injection.needs_small_turns; });
  Setting s;
  s.motion = static_cast<Motion>(still ? 2 + draw.below(2) : draw.below(4));
  s.has_gravity = s.motion == Motion::spin ? draw.chance(0.5) : s.motion != Motion::tumble;
  const char* const names[] = {"spin", "tumble", "swing", "rest"};
  c.maker = std::string("second: ") + names[static_cast<size_t>(s.motion)];
  const std::array<std::string, 3> stands = {"tabletop", "dumbbell", "hollow"};
  c.topology = s.has_gravity ? stands[static_cast<size_t>(draw.below(3))] : "free";
  s.swing_rad_s = draw.log_uniform(0.05, 0.5);
  return s;
}

// Any body has moments that are sums of two of three positive numbers.
void draw_body(RandomDraw& draw, InjectedCase& c) {
  InjectedWorld& world = c.world;
  world.mass_kg = as_written(draw.log_uniform(1.0, 60.0));
  const double radius_m = 0.1 * std::cbrt(world.mass_kg / 7.0) * draw.uniform(0.7, 1.5);
  const Triple spread = {draw.log_uniform(0.2, 1.0), draw.log_uniform(0.2, 1.0),
                         draw.log_uniform(0.2, 1.0)};
  const double unit = world.mass_kg * radius_m * radius_m;
  for (size_t k = 0; k < 3; ++k) {
    const double moment = unit * (spread[(k + 1) % 3] + spread[(k + 2) % 3]);
    world.inertia_kg_m2[k][k] = as_written(moment);
  }
  const Triple field = times(draw.uniform(2e-5, 6e-5), draw.direction());
  for (size_t k = 0; k < 3; ++k) world.magnetic_field_T[k] = as_written(field[k]);
  world.latitude_rad = std::round(draw.uniform(-60.0, 60.0)) * pi / 180.0;
}

void draw_priors(RandomDraw& draw, InjectedCase& c, const Setting& s,
                 const std::vector<Recipe>& recipes) {
  InjectedPriors& priors = c.priors;
  const auto& inertia = c.world.inertia_kg_m2;
  const double mean_kg_m2 = (inertia[0][0] + inertia[1][1] + inertia[2][2]) / 3.0;
  if (s.has_gravity) {
    const double level_kg_m2 = 0.5 * (inertia[0][0] + inertia[1][1]);
    const double below_m =
        s.swing_rad_s * s.swing_rad_s * level_kg_m2 / (c.world.mass_kg * c.world.gravity_m_s2);
    const double aside = s.motion == Motion::rest ? 0.005 : 0.05;
    priors.offset_m = {as_written(aside * below_m * draw.uniform(-1, 1)),
                       as_written(aside * below_m * draw.uniform(-1, 1)), as_written(-below_m)};
    const double sigma_m = as_written(draw.uniform(0.01, 0.03) * below_m);
    priors.offset_sigma_m = {sigma_m, sigma_m, as_written(draw.uniform(0.03, 0.1) * below_m)};
  } else {
    c.world.gravity_m_s2 = 0.0;
  }
  priors.drag_N_m_s = as_written(mean_kg_m2 / draw.log_uniform(3e3, 3e4));
  priors.drag_sigma_N_m_s = as_written(draw.uniform(0.15, 0.5) * priors.drag_N_m_s);
  priors.gyro_bias_sigma_rad_s = as_written(draw.log_uniform(1e-4, 3e-3));
  draw_truth_within_priors(draw, c, recipes);
}

void draw_instruments(RandomDraw& draw, InjectedCase& c, const InjectedPlan& plan, const Setting& s,
                      const std::vector<Recipe>& recipes) {
  InjectedSensors& sensors = c.sensors;
  const double rates_Hz[] = {5.0, 10.0, 20.0};
  sensors.rate_Hz = rates_Hz[static_cast<size_t>(draw.below(3))];
  // A camera has to see a fast spin more often than a slow swing.
  const int every[] = {1, 2, 4};
  sensors.camera_every = s.motion == Motion::spin ? 1 : every[static_cast<size_t>(draw.below(3))];
  const double level_arcsec = std::round(draw.log_uniform(6.0, 100.0));
  sensors.camera_noise_arcsec = {level_arcsec, level_arcsec,
                                 std::round(level_arcsec * draw.uniform(0.3, 1.5))};
  sensors.gyro_noise_rad_s = as_written(draw.log_uniform(3e-5, 1e-3));
  const bool of_gyro = any(recipes, [](const Recipe& r) { return r.instrument == "gyro"; });
  const bool commanded = any(recipes, [](const Recipe& r) {
    return r.injection.needs_commands || r.screening.needs == Requirement::command ||
           r.screening.needs == Requirement::charge;
  });
  sensors.has_gyro = of_gyro || draw.chance(0.75);
  sensors.has_commands = commanded || draw.chance(0.6);
  sensors.dirty = draw.chance(plan.dirty_fraction);
  // Nobody can count the turns of a fast spin in a gap of seconds without a gyro.
  if (s.motion == Motion::spin && !sensors.has_gyro) sensors.dirty = false;
}

InjectedStart draw_start(RandomDraw& draw, const InjectedCase& c, const Setting& s, bool still) {
  const auto in_any_direction = [&](double size) { return times(size, draw.direction()); };
  InjectedStart start;
  const Quaternion heading =
      quaternion_of({0, 0, still ? draw.uniform(-0.5, 0.5) : draw.uniform(-3.0, 3.0)});
  double tilt = 0.0;
  const double heading_of_tilt = draw.uniform(-pi, pi);
  switch (s.motion) {
    case Motion::spin:
      tilt = draw.uniform(0.01, 0.1);
      start.rate_rad_s = in_any_direction(draw.uniform(0.0, 0.02));
      start.rate_rad_s[2] += draw.sign() * draw.log_uniform(0.5, 2.0);
      break;
    case Motion::tumble:
      tilt = draw.uniform(0.0, 1.0);
      start.rate_rad_s = in_any_direction(draw.log_uniform(0.03, 0.3));
      break;
    case Motion::swing:
      tilt = c.topology == "hollow" ? draw.uniform(0.13, 0.26) : draw.uniform(0.17, 0.70);
      start.rate_rad_s = in_any_direction(draw.uniform(0.0, 0.02));
      start.rate_rad_s[2] = still ? draw.uniform(-0.003, 0.003) : draw.uniform(-0.05, 0.05);
      break;
    case Motion::rest:
      tilt = draw.log_uniform(0.002, 0.02);
      start.rate_rad_s = in_any_direction(draw.log_uniform(2e-4, 3e-3));
      break;
  }
  const Triple lean = {tilt * std::cos(heading_of_tilt), tilt * std::sin(heading_of_tilt), 0.0};
  start.attitude = normalised(product(heading, quaternion_of(lean)));
  return start;
}

}  // namespace

void draw_second_setting(RandomDraw& draw, InjectedCase& c, const InjectedPlan& plan,
                         const std::vector<Recipe>& recipes) {
  const Setting setting = draw_motion(draw, c, recipes);
  draw_body(draw, c);
  draw_priors(draw, c, setting, recipes);
  draw_instruments(draw, c, plan, setting, recipes);
  double durations_s[] = {plan.duration_s, plan.holdout_s};
  const double length = draw.uniform(0.0, 1.0);
  if (length < 0.25) {
    durations_s[0] = durations_s[1] = 60.0;
    c.maker += ", a minute";
  } else if (length > 0.95 && setting.motion != Motion::spin) {
    durations_s[0] = 3600.0;
    durations_s[1] = 1800.0;
    c.sensors.rate_Hz = 5.0;
    c.maker += ", an hour";
  }
  const bool still = any(recipes, [](const Recipe& r) { return r.injection.needs_small_turns; });
  const bool torques = c.sensors.has_commands &&
                       (any(recipes, [](const Recipe& r) { return r.injection.needs_commands; }) ||
                        draw.chance(0.4));
  // A push of some seconds turns the platform by a few hundredths of a radian a second.
  const auto& inertia = c.world.inertia_kg_m2;
  const double mean_kg_m2 = (inertia[0][0] + inertia[1][1] + inertia[2][2]) / 3.0;
  const double gentle = setting.motion == Motion::rest ? 0.2 : 1.0;
  const double torque_N_m = gentle * mean_kg_m2 * draw.log_uniform(0.002, 0.008);
  for (size_t i = 0; i < 2; ++i) {
    InjectedRun& run = c.runs[i];
    run.duration_s = durations_s[i];
    run.start = draw_start(draw, c, setting, still);
    if (!c.sensors.has_commands) continue;
    run.commands =
        draw_commands(draw, run.duration_s, c.sensors.rate_Hz, torques && !still, torque_N_m);
  }
}

}  // namespace photorque::injected
