// What the cases of a plan are made of: which effects, and the two makers of platform and motion.
//
// The first maker draws platforms of a laboratory that swing and turn slowly. The second draws
// what the first never does, so that a search is not tuned to one of them: free bodies, fast
// spins, large tilts, platforms almost at rest, minutes or an hour, other masses and instruments.
#pragma once

#include "tools/proof/case.h"
#include "tools/proof/recipes.h"

namespace photorque::injected {

struct Choice {
  std::string family, name;
  std::vector<Recipe> recipes;
  int number = 0;  // within its kind
  int level = 0;   // of a single effect: 0 strong, 1 medium, 2 weak, 3 below the limit
  bool second = false;
};

// The i-th of case_count(plan). Other effects stand together in another `variant`.
Choice choose(const InjectedPlan& plan, size_t index, uint64_t variant = 0);

// Platform, nominal model, instruments and both runs, such that `recipes` can act.
void draw_first_setting(RandomDraw& draw, InjectedCase& c, const InjectedPlan& plan,
                        const std::vector<Recipe>& recipes);
void draw_second_setting(RandomDraw& draw, InjectedCase& c, const InjectedPlan& plan,
                         const std::vector<Recipe>& recipes);

// Six significant digits, as the experiment file states it.
double as_written(double value);
// Torques in pulses at random, where wanted, and a battery current that alternates.
std::vector<InjectedCommand> draw_commands(RandomDraw& draw, double duration_s, double rate_Hz,
                                           bool torques, double largest_N_m);
// The true numbers of the nominal model, off by its uncertainties, which are zero where an effect
// of `recipes` could hide in them.
void draw_truth_within_priors(RandomDraw& draw, InjectedCase& c,
                              const std::vector<Recipe>& recipes);
bool any_injects(const std::vector<Recipe>& recipes, const std::string& kind);

}  // namespace photorque::injected
