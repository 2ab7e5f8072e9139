// Platforms of a laboratory: a tabletop, a dumbbell or a hollow ball that swings a little and turns
// slowly.
#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "tools/proof/plan.h"

namespace photorque::injected {
namespace {

void draw_platform(RandomDraw& draw, InjectedCase& c) {
  const std::array<std::string, 3> names = {"tabletop", "dumbbell", "hollow"};
  c.topology = names[static_cast<size_t>(draw.below(3))];
  Triple inertia;
  if (c.topology == "tabletop") {
    c.world.mass_kg = draw.uniform(6.5, 9.0);
    inertia = {draw.uniform(0.10, 0.13), draw.uniform(0.11, 0.13), draw.uniform(0.17, 0.205)};
  } else if (c.topology == "dumbbell") {
    c.world.mass_kg = draw.uniform(10.0, 15.5);
    do {
      inertia = {draw.uniform(0.05, 0.08), draw.uniform(0.47, 0.55), draw.uniform(0.47, 0.52)};
    } while (inertia[1] > inertia[0] + inertia[2]);  // no body has such moments
  } else {
    c.world.mass_kg = draw.uniform(4.5, 5.5);
    inertia = {draw.uniform(0.050, 0.056), draw.uniform(0.053, 0.058), draw.uniform(0.052, 0.057)};
  }
  c.world.mass_kg = as_written(c.world.mass_kg);
  for (size_t k = 0; k < 3; ++k) c.world.inertia_kg_m2[k][k] = as_written(inertia[k]);
  c.world.magnetic_field_T = {as_written(draw.uniform(-2e-6, 2e-6)),
                              as_written(draw.uniform(1.9e-5, 2.5e-5)),
                              as_written(draw.uniform(-4.3e-5, -3.5e-5))};
  c.world.latitude_rad = 45.5 * pi / 180.0;
}

// The nominal model, and a truth within it.
void draw_priors(RandomDraw& draw, InjectedCase& c, const std::vector<Recipe>& recipes) {
  InjectedPriors& priors = c.priors;
  priors.offset_m = {as_written(draw.uniform(-3e-6, 3e-6)), as_written(draw.uniform(-3e-6, 3e-6)),
                     as_written(draw.uniform(-6e-5, -2e-5))};
  priors.drag_N_m_s = as_written(draw.log_uniform(6e-6, 3e-5));
  priors.offset_sigma_m = {5e-7, 5e-7, 3e-6};
  priors.drag_sigma_N_m_s = as_written(draw.uniform(0.15, 0.3) * priors.drag_N_m_s);
  priors.gyro_bias_sigma_rad_s = 1e-3;
  draw_truth_within_priors(draw, c, recipes);
}

void draw_runs(RandomDraw& draw, InjectedCase& c, const InjectedPlan& plan,
               const std::vector<Recipe>& recipes) {
  const auto any = [&](auto member) { return std::ranges::any_of(recipes, member); };
  const bool torques =
      any([](const Recipe& r) { return r.injection.needs_commands; }) || draw.chance(0.2);
  const bool still = any([](const Recipe& r) { return r.injection.needs_small_turns; });
  const double durations_s[] = {plan.duration_s, plan.holdout_s};
  for (size_t i = 0; i < 2; ++i) {
    InjectedRun& run = c.runs[i];
    run.duration_s = durations_s[i];
    const Triple lean = times(draw.uniform(0.05, 0.2), draw.direction());
    run.start.attitude = normalised(
        product(quaternion_of({0, 0, still ? draw.uniform(-0.5, 0.5) : draw.uniform(-3, 3)}),
                quaternion_of({lean[0], lean[1], 0.0})));
    const double spin =
        draw.sign() * (still ? draw.uniform(0.001, 0.004) : draw.uniform(0.06, 0.2));
    run.start.rate_rad_s = {draw.uniform(-0.02, 0.02), draw.uniform(-0.02, 0.02), spin};
    run.commands = draw_commands(draw, run.duration_s, c.sensors.rate_Hz, torques, 6e-4);
  }
}

}  // namespace

void draw_truth_within_priors(RandomDraw& draw, InjectedCase& c,
                              const std::vector<Recipe>& recipes) {
  // An effect that could hide in an uncertain nominal model is injected where that nominal model is
  // exact.
  InjectedPriors& priors = c.priors;
  if (any_injects(recipes, nominal_unbalance)) priors.offset_sigma_m = {};
  if (any_injects(recipes, nominal_drag)) priors.drag_sigma_N_m_s = 0.0;
  if (any_injects(recipes, nominal_gyro_bias)) priors.gyro_bias_sigma_rad_s = 0.0;
  c.world.offset_m = plus(priors.offset_m, by_component(priors.offset_sigma_m, draw.normals(1.0)));
  c.world.drag_N_m_s = std::max(0.2 * priors.drag_N_m_s,
                                priors.drag_N_m_s + priors.drag_sigma_N_m_s * draw.normal());
  c.world.gyro_bias_rad_s = draw.normals(priors.gyro_bias_sigma_rad_s);
}

void draw_first_setting(RandomDraw& draw, InjectedCase& c, const InjectedPlan& plan,
                        const std::vector<Recipe>& recipes) {
  c.maker = "first";
  draw_platform(draw, c);
  draw_priors(draw, c, recipes);
  c.sensors.rate_Hz =
      plan.rates_Hz[static_cast<size_t>(draw.below(static_cast<int>(plan.rates_Hz.size())))];
  c.sensors.camera_every = draw.chance(0.3) ? 2 : 1;
  c.sensors.dirty = draw.chance(plan.dirty_fraction);
  draw_runs(draw, c, plan, recipes);
}

}  // namespace photorque::injected
