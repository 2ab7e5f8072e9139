#include "tools/proof/light/case.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/errors.h"

namespace photorque {
namespace {

using namespace injected;

struct Choice {
  std::string family, name;
  std::vector<std::string> kinds;
  int level = 0;  // of a single effect: 0 strong, 1 medium, 2 weak
};

// Two of these act together only where both show in the same recordings.
bool go_together(const std::string& a, const std::string& b) {
  const auto in = [](const std::string& kind, const std::vector<std::string>& list) {
    return std::ranges::find(list, kind) != list.end();
  };
  const std::vector<std::string> only_runs = {"led_droop", "tracker_trapped"},
                                 never_runs = {"detector_gain", "interreflection", "string_open",
                                               "bypass_shorted", "unmodelled_shadow"};
  if (a == b || (in(a, only_runs) && in(b, never_runs)) || (in(b, only_runs) && in(a, never_runs)))
    return false;
  // Both on one lamp, or what nothing can tell apart.
  const std::vector<std::string> powers = {"source_power", "soiling", "detector_gain"},
                                 dark = {"led_failed", "led_derated"};
  return !(in(a, powers) && in(b, powers)) && !(in(a, dark) && in(b, dark));
}

Choice choose(const LightPlan& plan, size_t index, uint64_t variant) {
  const auto& kinds = injected_light_kinds();
  const auto& laws = injected_light_laws();
  const auto named = [](const std::string& family, std::vector<std::string> of, size_t number,
                        int level) {
    std::string name = of.empty() ? "nothing" : of[0];
    if (of.size() > 1) name += "+" + of[1];
    char text[16];
    std::snprintf(text, sizeof text, "_%02d", static_cast<int>(number) + 1);
    return Choice{family, name + text, std::move(of), level};
  };
  const auto count = [](int n) { return static_cast<size_t>(std::max(0, n)); };
  size_t i = index;
  if (i < kinds.size() * count(plan.per_kind)) {
    const size_t number = i / kinds.size();
    return named("single", {kinds[i % kinds.size()]}, number,
                 static_cast<int>((number + i % 3) % 3));
  }
  i -= kinds.size() * count(plan.per_kind);
  if (i < count(plan.none)) return named("none", {}, i, 0);
  i -= count(plan.none);
  RandomDraw draw(plan.seed, 7000 + index + 100000 * variant);
  if (i < count(plan.pairs)) {
    for (;;) {
      const auto some = [&] { return kinds[static_cast<size_t>(draw.below(int(kinds.size())))]; };
      const std::string a = some(), b = some();
      if (go_together(a, b)) return named("pair", {a, b}, i, 1);
    }
  }
  i -= count(plan.pairs);
  if (i < laws.size() * count(plan.outside)) {
    return named("outside", {laws[i % laws.size()]}, i / laws.size(), 1);
  }
  i -= laws.size() * count(plan.outside);
  // Below what shows: kinds that can be as weak as one likes.
  const std::vector<std::string> weak = {
      "led_derated",       "led_aim",       "beam_divergence",
      "source_shift",      "source_power",  "led_droop",
      "soiling",           "ambient_light", "attitude_bias",
      "detector_gain",     "cell_degraded", "cell_shaded",
      "series_resistance", "shunt",         "temperature_coefficient"};
  return named("below", {weak[i % weak.size()]}, i / weak.size(), 3);
}

// The strength at which chi² grows by `wanted`; above 1 where it cannot.
double strength_for(const LightJudge& judge, const LightRecipe& recipe, double wanted) {
  if (!recipe.has_strength) return judge.gain({recipe.at(1.0)}) > 30.0 ? 1.0 : 2.0;
  if (judge.gain({recipe.at(1.0)}) < wanted) return wanted > 100.0 ? 1.0 : 2.0;
  double low = std::log(1e-5), high = 0.0;
  for (int i = 0; i < 14; ++i) {
    const double middle = 0.5 * (low + high);
    (judge.gain({recipe.at(std::exp(middle))}) < wanted ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

double duration_of(const LightCase& c) {
  for (const auto& recording : c.recordings) {
    if (!recording.rows.time_s.empty()) return recording.rows.time_s.back();
  }
  return 0.0;
}

// chi² gains: strong, medium, weak, below the limit.
double wanted_gain(RandomDraw& draw, const Choice& choice) {
  if (choice.family == "below") return draw.log_uniform(0.3, 3.0);
  if (choice.family == "pair") return draw.log_uniform(500.0, 50000.0);
  if (choice.family == "outside") return draw.log_uniform(1000.0, 20000.0);
  if (choice.level == 0) return draw.log_uniform(2e4, 1e6);
  if (choice.level == 1) return draw.log_uniform(1000.0, 2e4);
  return draw.log_uniform(100.0, 1000.0);
}

// A curve that now opens far below where the array was thought to would end in currents that no
// instrument drives backwards: it ends at its own open circuit. Whether any did.
bool shorten_sweeps(LightCase& c) {
  constexpr double far = 0.97, beyond = 1.003;
  const LightWorld truth = c.truth();
  bool any = false;
  for (auto& recording : c.recordings) {
    LightRows& rows = recording.rows;
    if (rows.kind != LightRows::Kind::sweep) continue;
    for (size_t first = 0, last = 0; first < rows.size(); first = last) {
      while (last < rows.size() && rows.sweep[last] == rows.sweep[first]) ++last;
      const LitCircuit circuit(truth.circuit, light_on_cells(truth, rows.attitude[first]),
                               rows.temperature_K[first]);
      const double scale = beyond * circuit.open_voltage_V() / rows.voltage_V[last - 1];
      if (scale > far) continue;
      any = true;
      for (size_t i = first; i < last; ++i) rows.voltage_V[i] *= scale;
    }
  }
  return any;
}

std::vector<std::string> depends_on(const std::string& law) {
  if (law == "slow_drift" || law == "flicker") return {"time"};
  return {"position", "irradiance"};
}

}  // namespace

LightWorld LightCase::truth() const {
  LightWorld world = believed;
  for (const LightEffect& effect : effects) act(effect, world);
  return world;
}

const std::vector<std::string>& injected_light_kinds() {
  static const std::vector<std::string> kinds = {"led_failed",
                                                 "led_derated",
                                                 "led_aim",
                                                 "beam_divergence",
                                                 "source_shift",
                                                 "source_power",
                                                 "led_droop",
                                                 "ambient_light",
                                                 "unmodelled_shadow",
                                                 "attitude_bias",
                                                 "interreflection",
                                                 "detector_gain",
                                                 "soiling",
                                                 "angular_response",
                                                 "cell_degraded",
                                                 "cell_shaded",
                                                 "string_open",
                                                 "bypass_shorted",
                                                 "series_resistance",
                                                 "shunt",
                                                 "temperature_coefficient",
                                                 "tracker_trapped"};
  return kinds;
}

const std::vector<std::string>& injected_light_laws() {
  static const std::vector<std::string> laws = {"ripple", "vignetting", "hair", "slow_drift",
                                                "flicker"};
  return laws;
}

size_t light_case_count(const LightPlan& plan) {
  const auto count = [](int n) { return static_cast<size_t>(std::max(0, n)); };
  return injected_light_kinds().size() * count(plan.per_kind) + count(plan.none) +
         count(plan.pairs) + injected_light_laws().size() * count(plan.outside) + count(plan.below);
}

LightCase draw_light_case(const LightPlan& plan, size_t index) {
  constexpr int attempts = 40;
  constexpr double shows = 30.0;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const Choice choice = choose(plan, index, static_cast<uint64_t>(attempt));
    LightCase c;
    c.name = choice.name;
    c.family = choice.family;
    c.seed = plan.seed * 1000003 + index * 101 + static_cast<uint64_t>(attempt);
    RandomDraw draw(c.seed, 1);
    c.dirty = draw.chance(plan.dirty_share);
    draw_light_setting(draw, c, choice.kinds);
    c.verdict = choice.family == "outside" ? "unexplained"
                : choice.kinds.empty()     ? "consistent"
                                           : "missing_physics";
    if (choice.kinds.empty()) {
      c.accept = {{}};
      return c;
    }
    const LightJudge judge(c);
    bool drawn = true;
    for (const std::string& kind : choice.kinds) {
      const LightRecipe recipe = draw_light_effect(draw, c.believed, kind, duration_of(c));
      const double strength = strength_for(judge, recipe, wanted_gain(draw, choice));
      if (strength > 1.0) drawn = false;
      if (drawn) c.effects.push_back(recipe.at(strength));
    }
    if (!drawn) continue;
    std::optional<LightJudge> of_shortened;
    if (shorten_sweeps(c)) of_shortened.emplace(c);
    const LightJudge& last = of_shortened ? *of_shortened : judge;
    c.chi2_gain = last.gain(c.effects);
    if (c.family == "below") {
      c.below = true;
      c.accept = {{}, {choice.kinds[0]}};
      return c;
    }
    if (c.chi2_gain < 2.0 * shows) continue;
    if (c.family == "outside") {
      c.chi2_gain = last.judge(c, shows);
      if (c.chi2_gain < 3.0 * shows) continue;
      c.accept = {{}};
      c.depends_on = depends_on(choice.kinds[0]);
      return c;
    }
    const double left_by_one = last.judge(c, shows);
    // A pair of which one is hardly needed is no pair.
    if (choice.kinds.size() == 2 && left_by_one < 5.0 * shows) continue;
    return c;
  }
  throw NumericalError("no case " + choose(plan, index, 0).name + " that shows was found");
}

}  // namespace photorque
