#include "tools/proof/case.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "tools/proof/plan.h"
#include "tools/proof/strength.h"

namespace photorque {
namespace {

using namespace injected;

// Of chi² by each effect.
double wanted_gain(RandomDraw& draw, const InjectedPlan& plan, const Choice& choice) {
  if (choice.family != "single") return draw.log_uniform(300.0, 2e4);
  switch (choice.level) {
    case 0:
      if (draw.chance(plan.strong_fraction)) return draw.log_uniform(1e5, 1e9);
      return draw.log_uniform(2e3, 5e4);
    case 1:
      return draw.log_uniform(200.0, 2e3);
    case 2:
      return draw.log_uniform(40.0, 200.0);
    default:
      return draw.log_uniform(0.2, 4.0);
  }
}

InjectedNoise draw_correlated(RandomDraw& draw) {
  return {.time_s = draw.log_uniform(0.3, 4.0)};
}

InjectedNoise draw_heavy_tails(RandomDraw& draw) {
  if (draw.chance(0.5)) return {.student_degrees = 3 + draw.below(3)};
  return {.outlier_share = 0.05};
}

// One trouble in turn for the camera, the gyro or both; three scaled, three correlated, three with
// heavy tails, and then in turn one quantised and one with all of it.
void draw_noise(RandomDraw& draw, InjectedSensors& sensors, int number) {
  const int which = sensors.has_gyro ? draw.below(3) : 0;  // camera, gyro, both
  const auto draw_one = [&]() -> InjectedNoise {
    const int kind = number % 10;
    if (kind == 9 && (number / 10) % 2 == 0) return {.step_sigma = draw.uniform(1.0, 3.0)};
    if (kind == 9) {
      InjectedNoise noise = draw_heavy_tails(draw);
      noise.scale = draw.log_uniform(0.6, 2.0);
      noise.time_s = draw.log_uniform(0.3, 2.0);
      noise.step_sigma = draw.uniform(0.5, 1.5);
      return noise;
    }
    if (kind % 3 == 1) return draw_correlated(draw);
    if (kind % 3 == 2) return draw_heavy_tails(draw);
    // Far enough from the stated level that it shows in minutes.
    return {.scale = draw.chance(0.4) ? draw.log_uniform(0.6, 0.85) : draw.log_uniform(1.2, 2.0)};
  };
  if (which != 1) sensors.camera = draw_one();
  if (which != 0) sensors.gyro = draw_one();
}

void draw_correlated_noise(RandomDraw& draw, InjectedSensors& sensors) {
  const int which = sensors.has_gyro ? draw.below(3) : 0;
  if (which != 1) sensors.camera = draw_correlated(draw);
  if (which != 0) sensors.gyro = draw_correlated(draw);
}

void judge(InjectedCase& c, const Choice& choice, const Strengths& strengths) {
  constexpr double limit = 30.0, hopeless = 6.0;
  std::vector<std::string> known;
  for (const Recipe& r : choice.recipes) {
    if (r.outside) {
      c.depends_on = r.depends_on;
    } else {
      known.push_back(r.kind);
    }
  }
  c.chi2_gain = strengths.least();
  c.accept = {known};
  if (known.size() < choice.recipes.size()) {
    c.verdict = "unexplained";
    if (!known.empty()) c.accept.push_back({});
  } else {
    c.verdict = known.empty() || c.chi2_gain < hopeless ? "consistent" : "missing_physics";
  }
  if (c.chi2_gain >= hopeless) {
    c.accept.insert(c.accept.end(), strengths.doubles.begin(), strengths.doubles.end());
  }
  if (c.verdict == "missing_physics" && c.chi2_gain < limit) c.accept.push_back({});
  if (c.verdict == "consistent" && !known.empty()) c.accept.push_back({});
}

// Whether the effects show as the family asks; what has no strength shows as it does.
bool shows(const InjectedCase& c, const Choice& choice, const std::vector<double>& wanted) {
  if (choice.recipes.empty()) return true;
  if (c.world.effects[0].parameters.empty()) return true;
  const double most = *std::ranges::max_element(wanted);
  if (c.chi2_gain > 10.0 * most) return false;  // not reached in a few rounds
  return c.chi2_gain >= (choice.family == "single" ? 0.5 * std::min(most, 400.0) : 200.0);
}

bool attempt(InjectedCase& c, const InjectedPlan& plan, const Choice& choice, uint64_t stream) {
  RandomDraw draw(plan.seed, stream);
  c = {};
  c.family = choice.family;
  c.seed = hash_words(plan.seed, stream, 9);
  (choice.second ? draw_second_setting : draw_first_setting)(draw, c, plan, choice.recipes);
  if (choice.family == "noise_none") draw_noise(draw, c.sensors, choice.number);
  if (choice.family == "noise_effect") draw_correlated_noise(draw, c.sensors);
  const ExampleConditions conditions{c.runs[0].duration_s, c.world.inertia_kg_m2,
                                     0.25 * c.sensors.rate_Hz / c.sensors.camera_every};
  std::vector<double> wanted;
  for (const Recipe& r : choice.recipes) {
    c.world.effects.push_back({r.kind, r.injection.draw(draw, conditions)});
    wanted.push_back(wanted_gain(draw, plan, choice));
  }
  // The sizes that the kinds draw are those of a platform of the first maker.
  const double loosened = choice.second ? 20.0 : 1.0;
  const Strengths strengths = fit_strengths(c, choice.recipes, wanted, loosened);
  judge(c, choice, strengths);
  return shows(c, choice, wanted) && stays_physical(c);
}

}  // namespace

InjectedCase draw_case(const InjectedPlan& plan, size_t index) {
  InjectedCase c;
  for (uint64_t trial = 0; trial < 40; ++trial) {
    // Effects that never show together make room for others.
    const Choice choice = choose(plan, index, trial / 8);
    try {
      if (!attempt(c, plan, choice, index * 100 + trial)) continue;
    } catch (const NumericalError&) {
      continue;  // an effect so strong that the platform tumbles away
    }
    const std::string number = std::to_string(choice.number + 1);
    c.name = choice.name + "_" + (number.size() < 2 ? "0" : "") + number;
    if (choice.family.starts_with("noise")) c.name = choice.family + "_" + c.name;
    return c;
  }
  throw NumericalError("no visible case of " + choose(plan, index).name + " in forty trials");
}

}  // namespace photorque
