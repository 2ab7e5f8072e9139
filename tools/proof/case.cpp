#include "tools/proof/case.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "tools/proof/information.h"
#include "tools/proof/recipes.h"

namespace photorque {
namespace {

using namespace injected;

// Six significant digits, as the experiment file states it.
double as_written(double value) {
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 5);
  return std::round(value / unit) * unit;
}

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
  const auto injects = [&](const std::string& kind) {
    return std::ranges::any_of(recipes, [&](const Recipe& r) { return r.kind == kind; });
  };
  InjectedPriors& priors = c.priors;
  priors.offset_m = {as_written(draw.uniform(-3e-6, 3e-6)), as_written(draw.uniform(-3e-6, 3e-6)),
                     as_written(draw.uniform(-6e-5, -2e-5))};
  priors.drag_N_m_s = as_written(draw.log_uniform(6e-6, 3e-5));
  priors.offset_sigma_m = {5e-7, 5e-7, 3e-6};
  priors.drag_sigma_N_m_s = as_written(draw.uniform(0.15, 0.3) * priors.drag_N_m_s);
  priors.gyro_bias_sigma_rad_s = 1e-3;
  // An effect that could hide in an uncertain nominal model is injected where that nominal model is
  // exact.
  if (injects(nominal_unbalance)) priors.offset_sigma_m = {};
  if (injects(nominal_drag)) priors.drag_sigma_N_m_s = 0.0;
  if (injects(nominal_gyro_bias)) priors.gyro_bias_sigma_rad_s = 0.0;
  c.world.offset_m = plus(priors.offset_m, by_component(priors.offset_sigma_m, draw.normals(1.0)));
  c.world.drag_N_m_s = std::max(0.2 * priors.drag_N_m_s,
                                priors.drag_N_m_s + priors.drag_sigma_N_m_s * draw.normal());
  c.world.gyro_bias_rad_s = draw.normals(priors.gyro_bias_sigma_rad_s);
}

std::vector<InjectedCommand> draw_commands(RandomDraw& draw, double duration_s, double rate_Hz,
                                           bool torques) {
  const auto on_row = [&](double t) { return std::round(t * rate_Hz) / rate_Hz; };
  const double current_A = std::round(draw.uniform(2.4, 6.0) * 100.0) / 100.0;
  const double half_period_s = on_row(draw.uniform(60.0, 140.0));
  std::vector<double> pulses;  // begin, end, begin, …
  for (double t = draw.uniform(5.0, 20.0); torques && t < duration_s;) {
    pulses.push_back(on_row(t));
    pulses.push_back(on_row(t + draw.uniform(2.0, 9.0)));
    t = pulses.back() + draw.uniform(3.0, 60.0);
  }
  std::vector<double> edges_s = {0.0};
  for (double t = half_period_s; t < duration_s; t += half_period_s) edges_s.push_back(on_row(t));
  edges_s.insert(edges_s.end(), pulses.begin(), pulses.end());
  std::ranges::sort(edges_s);
  edges_s.erase(std::ranges::unique(edges_s).begin(), edges_s.end());
  std::vector<InjectedCommand> commands;
  Triple torque = {};
  for (const double t : edges_s) {
    const auto edge = std::ranges::find(pulses, t);
    if (edge != pulses.end()) {
      const bool begins = (edge - pulses.begin()) % 2 == 0;
      torque = begins ? times(as_written(draw.uniform(1e-4, 6e-4)), draw.direction()) : Triple{};
    }
    const bool full = static_cast<int>(std::floor(t / half_period_s + 1e-6)) % 2 == 0;
    commands.push_back({t, torque, full ? current_A : std::round(35.0 * current_A) / 100.0});
  }
  return commands;
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
    run.commands = draw_commands(draw, run.duration_s, c.sensors.rate_Hz, torques);
  }
}

// Smaller where the effect is strong, so that the change is linear in it.
double fraction_of(double gain) {
  return std::min(1.0, 3.0 / std::sqrt(std::max(gain, 1e-30)));
}

// The gain of effect `index`, with all numbers of the case's other effects free.
double own_gain(const InjectedCase& c, size_t index, bool against_catalogue) {
  const InjectedInformation information(c);
  std::vector<Eigen::MatrixXd> others;
  if (against_catalogue) {
    for (const std::string& kind : information.competitors()) {
      others.push_back(information.columns_of(kind));
    }
  }
  for (size_t i = 0; i < c.world.effects.size(); ++i) {
    if (i == index) continue;
    // The other may be of any strength and direction.
    Eigen::MatrixXd columns = information.columns_of(c.world.effects[i].kind);
    if (columns.cols() == 0) columns = information.change_by(i, 1e-3);
    others.push_back(std::move(columns));
  }
  return information.gain(information.change_by(index, 1e-3), others);
}

// Scales effect `index` until chi² gains about `wanted`, as far as its recipe allows.
double fit_strength(InjectedCase& c, size_t index, const Recipe& recipe, double wanted) {
  double gain = 0.0, total = 1.0;
  for (int round = 0; round < 3; ++round) {
    gain = own_gain(c, index, recipe.outside);
    if (c.world.effects[index].parameters.empty() || !(gain > 0.0)) break;
    const double by =
        std::clamp(std::sqrt(wanted / gain), 1e-4 / total, recipe.injection.max_factor / total);
    scale_effect(c.world.effects[index], by);
    total *= by;
    if (std::abs(by - 1.0) < 0.02) break;
  }
  return own_gain(c, index, recipe.outside);
}

// Kinds that could pass for one of the effects: what they leave of it is within the noise.
void add_doubles(InjectedCase& c, const std::vector<std::string>& names) {
  const InjectedInformation information(c);
  constexpr double within_noise = 12.0;
  for (size_t i = 0; i < names.size(); ++i) {
    const double fraction = std::min(1e-2, fraction_of(c.chi2_gain));
    const Eigen::VectorXd change = information.change_by(i, fraction);
    std::vector<Eigen::MatrixXd> others;  // free as well
    for (size_t k = 0; k < names.size(); ++k) {
      if (k != i) others.push_back(information.columns_of(names[k]));
    }
    for (const std::string& kind : information.competitors()) {
      if (std::ranges::find(names, kind) != names.end()) continue;
      others.push_back(information.columns_of(kind));
      const double left = information.gain(change, others);
      others.pop_back();
      if (left >= within_noise) continue;
      c.accept.push_back(names);
      c.accept.back()[i] = kind;
    }
  }
}

struct Choice {
  std::string family, name;
  std::vector<Recipe> recipes;
  int number = 0;  // within its kind
};

// Whether both together are one effect: a torque about the vertical is a draught too.
bool is_part_of(const Recipe& recipe, const Recipe& other) {
  return std::ranges::any_of(recipe.screening.alike, [&](const Likeness& l) {
    return l.kind == other.kind && l.told_apart_by == Requirement::none;
  });
}

Choice choose(const InjectedPlan& plan, size_t index) {
  auto i = static_cast<int>(index);
  if (i < plan.none) return {"none", "none", {}, i};
  i -= plan.none;
  std::vector<Recipe> inside, outside;
  for (const Recipe& r : recipes()) (r.outside ? outside : inside).push_back(r);
  // Round by round over all kinds, so that a part of the plan has all of them.
  if (i < plan.per_kind * static_cast<int>(inside.size())) {
    const auto k = static_cast<size_t>(i) % inside.size();
    return {"single", inside[k].kind, {inside[k]}, i / static_cast<int>(inside.size())};
  }
  i -= plan.per_kind * static_cast<int>(inside.size());
  if (i < plan.pairs) {
    std::erase_if(inside, [](const Recipe& r) { return !r.injection.pairs; });
    RandomDraw draw(plan.seed, 1000003 + static_cast<uint64_t>(i));
    const auto count = static_cast<int>(inside.size());
    Recipe a, b;
    do {
      const int first = draw.below(count), second = first + 1 + draw.below(count - 1);
      a = inside[static_cast<size_t>(first)];
      b = inside[static_cast<size_t>(second % count)];
    } while (is_part_of(a, b) || is_part_of(b, a));
    return {"pair", a.kind + "+" + b.kind, {a, b}, i};
  }
  i -= plan.pairs;
  const auto k = static_cast<size_t>(i) % outside.size();
  return {"outside", outside[k].kind, {outside[k]}, i / static_cast<int>(outside.size())};
}

// Of chi²: strong, medium, weak, below the limit, and again.
double wanted_gain(RandomDraw& draw, const Choice& choice) {
  if (choice.family != "single") return draw.log_uniform(300.0, 2e4);
  switch (choice.number % 4) {
    case 0:
      return draw.log_uniform(2e3, 5e4);
    case 1:
      return draw.log_uniform(200.0, 2e3);
    case 2:
      return draw.log_uniform(40.0, 200.0);
    default:
      return draw.log_uniform(0.2, 4.0);
  }
}

void judge(InjectedCase& c, const Choice& choice) {
  constexpr double limit = 30.0, hopeless = 6.0;
  std::vector<std::string> names;
  for (const Recipe& r : choice.recipes) names.push_back(r.kind);
  if (choice.family == "outside") {
    c.verdict = "unexplained";
    c.accept = {{}};
    c.depends_on = {choice.recipes[0].depends_on};
    return;
  }
  c.verdict = names.empty() || c.chi2_gain < hopeless ? "consistent" : "missing_physics";
  c.accept = {names};
  if (c.verdict == "missing_physics") add_doubles(c, names);
  if (c.chi2_gain < limit && !names.empty()) c.accept.push_back({});
}

bool attempt(InjectedCase& c, const InjectedPlan& plan, const Choice& choice, uint64_t stream) {
  RandomDraw draw(plan.seed, stream);
  c = {};
  c.family = choice.family;
  c.seed = hash_words(plan.seed, stream, 9);
  draw_platform(draw, c);
  draw_priors(draw, c, choice.recipes);
  c.sensors.rate_Hz =
      plan.rates_Hz[static_cast<size_t>(draw.below(static_cast<int>(plan.rates_Hz.size())))];
  c.sensors.camera_every = draw.chance(0.3) ? 2 : 1;
  c.sensors.dirty = draw.chance(plan.dirty_fraction);
  draw_runs(draw, c, plan, choice.recipes);
  const ExampleConditions conditions{c.runs[0].duration_s, c.world.inertia_kg_m2,
                                     0.25 * c.sensors.rate_Hz / c.sensors.camera_every};
  for (const Recipe& r : choice.recipes) {
    c.world.effects.push_back({r.kind, r.injection.draw(draw, conditions)});
  }
  const double wanted = wanted_gain(draw, choice);
  c.chi2_gain = choice.recipes.empty() ? 0.0 : 1e300;
  for (size_t i = 0; i < choice.recipes.size(); ++i) {
    c.chi2_gain = std::min(c.chi2_gain, fit_strength(c, i, choice.recipes[i], wanted));
  }
  // Two effects, or a law that no other can pass for, must show.
  if ((choice.family == "pair" || choice.family == "outside") && c.chi2_gain < 200.0) return false;
  judge(c, choice);
  return true;
}

}  // namespace

size_t case_count(const InjectedPlan& plan) {
  size_t inside = 0, outside = 0;
  for (const Recipe& r : recipes()) ++(r.outside ? outside : inside);
  return static_cast<size_t>(plan.none + plan.pairs) + static_cast<size_t>(plan.per_kind) * inside +
         static_cast<size_t>(plan.outside) * outside;
}

InjectedCase draw_case(const InjectedPlan& plan, size_t index) {
  const Choice choice = choose(plan, index);
  InjectedCase c;
  for (uint64_t trial = 0; trial < 20; ++trial) {
    try {
      if (!attempt(c, plan, choice, index * 100 + trial)) continue;
    } catch (const NumericalError&) {
      continue;  // an effect so strong that the platform tumbles away
    }
    const std::string number = std::to_string(choice.number + 1);
    c.name = choice.name + "_" + (number.size() < 2 ? "0" : "") + number;
    return c;
  }
  throw NumericalError("no visible case of " + choice.name + " in twenty trials");
}

}  // namespace photorque
