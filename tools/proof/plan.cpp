#include "tools/proof/plan.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"

namespace photorque {
namespace injected {
namespace {

struct Kinds {
  std::vector<Recipe> inside, companions, adjustable, outside;
};

const Kinds& kinds() {
  static const Kinds all = [] {
    Kinds k;
    for (const Recipe& r : recipes()) {
      if (r.outside) {
        k.outside.push_back(r);
        continue;
      }
      k.inside.push_back(r);
      if (r.injection.pairs) k.companions.push_back(r);
      if (!r.injection.strength.empty()) k.adjustable.push_back(r);
    }
    return k;
  }();
  return all;
}

// Whether both together are one effect: a torque about the vertical is a draught too.
bool is_part_of(const Recipe& recipe, const Recipe& other) {
  return std::ranges::any_of(recipe.screening.alike, [&](const Likeness& l) {
    return l.kind == other.kind && l.told_apart_by == Requirement::none;
  });
}

// Different kinds of which none is part of another.
std::vector<Recipe> draw_companions(RandomDraw& draw, size_t count) {
  const std::vector<Recipe>& from = kinds().companions;
  std::vector<Recipe> chosen;
  while (chosen.size() < count) {
    const Recipe& next = from[static_cast<size_t>(draw.below(static_cast<int>(from.size())))];
    const bool clashes = std::ranges::any_of(chosen, [&](const Recipe& r) {
      return r.kind == next.kind || is_part_of(r, next) || is_part_of(next, r);
    });
    if (!clashes) chosen.push_back(next);
  }
  return chosen;
}

Choice several(const InjectedPlan& plan, const std::string& family, size_t count, int i,
               uint64_t variant) {
  RandomDraw draw(plan.seed, 1000003 * count + static_cast<uint64_t>(i) + 100003 * variant);
  Choice choice{family, "", draw_companions(draw, count), i};
  for (const Recipe& r : choice.recipes) choice.name += (choice.name.empty() ? "" : "+") + r.kind;
  return choice;
}

Choice known_and_unknown(const InjectedPlan& plan, int i, uint64_t variant) {
  RandomDraw draw(plan.seed, 7000003 + static_cast<uint64_t>(i) + 100003 * variant);
  const std::vector<Recipe>& outside = kinds().outside;
  const Recipe known = draw_companions(draw, 1)[0];
  const Recipe& unknown = outside[static_cast<size_t>(i) % outside.size()];
  return {"known_unknown", known.kind + "+" + unknown.kind, {known, unknown}, i};
}

// Round by round over all kinds, so that a part of the plan has all of them: strong, medium, then
// half of them weak and half below the limit, and the other way round.
Choice single(int i) {
  const std::vector<Recipe>& inside = kinds().inside;
  const auto count = static_cast<int>(inside.size());
  const Recipe& recipe = inside[static_cast<size_t>(i % count)];
  const int number = i / count, turn = number % 4;
  return {"single", recipe.kind, {recipe}, number, turn < 2 ? turn : 2 + (turn + i) % 2};
}

Choice of_family(const InjectedPlan& plan, int i, uint64_t variant) {
  const auto& [inside, companions, adjustable, outside] = kinds();
  if (i < plan.none) return {"none", "none", {}, i};
  i -= plan.none;
  const int singles = plan.per_kind * static_cast<int>(inside.size());
  if (i < singles) return single(i);
  i -= singles;
  if (i < plan.pairs) return several(plan, "pair", 2, i, variant);
  i -= plan.pairs;
  const auto laws = static_cast<int>(outside.size());
  if (i < plan.outside * laws) {
    const Recipe& law = outside[static_cast<size_t>(i % laws)];
    return {"outside", law.kind, {law}, i / laws};
  }
  i -= plan.outside * laws;
  if (i < plan.triples) return several(plan, "triple", 3, i, variant);
  i -= plan.triples;
  if (i < plan.known_unknown) return known_and_unknown(plan, i, variant);
  i -= plan.known_unknown;
  if (i < plan.noise_none) return {"noise_none", "none", {}, i};
  i -= plan.noise_none;
  // Not in the order of the catalogue, of which a short plan would see but the first.
  const Recipe& recipe = adjustable[static_cast<size_t>(7 * i) % adjustable.size()];
  return {"noise_effect", recipe.kind, {recipe}, i};
}

// One of every 1/fraction cases, at a random place among them.
bool is_of_second_maker(const InjectedPlan& plan, size_t index) {
  if (plan.second_fraction <= 0.0) return false;
  const double block = std::floor(static_cast<double>(index) * plan.second_fraction);
  const double first = std::ceil(block / plan.second_fraction - 1e-9);
  const double next = std::ceil((block + 1.0) / plan.second_fraction - 1e-9);
  RandomDraw draw(plan.seed, 9000011 + static_cast<uint64_t>(block));
  return static_cast<double>(index) == first + std::floor(draw.uniform(0.0, next - first));
}

}  // namespace

Choice choose(const InjectedPlan& plan, size_t index, uint64_t variant) {
  Choice choice = of_family(plan, static_cast<int>(index), variant);
  choice.second = is_of_second_maker(plan, index);
  return choice;
}

bool any_injects(const std::vector<Recipe>& recipes, const std::string& kind) {
  return std::ranges::any_of(recipes, [&](const Recipe& r) { return r.kind == kind; });
}

double as_written(double value) {
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 5);
  return std::round(value / unit) * unit;
}

std::vector<InjectedCommand> draw_commands(RandomDraw& draw, double duration_s, double rate_Hz,
                                           bool torques, double largest_N_m) {
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
      const double size_N_m = draw.uniform(largest_N_m / 6.0, largest_N_m);
      torque = begins ? times(as_written(size_N_m), draw.direction()) : Triple{};
    }
    const bool full = static_cast<int>(std::floor(t / half_period_s + 1e-6)) % 2 == 0;
    commands.push_back({t, torque, full ? current_A : std::round(35.0 * current_A) / 100.0});
  }
  return commands;
}

}  // namespace injected

size_t case_count(const InjectedPlan& plan) {
  const auto& all = injected::kinds();
  return static_cast<size_t>(plan.none + plan.pairs + plan.triples + plan.known_unknown +
                             plan.noise_none + plan.noise_effect) +
         static_cast<size_t>(plan.per_kind) * all.inside.size() +
         static_cast<size_t>(plan.outside) * all.outside.size();
}

}  // namespace photorque
