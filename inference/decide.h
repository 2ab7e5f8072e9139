// The verdict on the trials of any domain. Every name passes the same gates:
//
//   (a) it, or an effect not distinguished from it, is probable; else it is only a candidate;
//   (b) each of its groups of parameters differs from neutral;
//   (c) segments that a fit left out are predicted better with it than without it;
//   (d) with all names the held-out χ² agrees with its prediction; else the finding is unknown;
//   (e) where the nominal model predicts the held-out data as well, these do not test the names;
//   (f) of places that explain the data as well all are listed with it.
#pragma once

#include <functional>
#include <utility>

#include "inference/domain.h"

namespace photorque::inference {

enum class Finding {
  nothing_missing,  // differences are noise
  named,            // the named candidates explain the differences
  unknown,          // structure is left after them, or only an empirical candidate takes it up
};

// Limits of the gates beside those of Thresholds::Decision.
struct GateLimits {
  // Standard errors over left-out segments by which they are predicted better with a name than
  // without it.
  double min_gain_sigma = 3.0;
  // χ² of the held-out data over that of the nominal model, above which they do not test a name.
  double max_untested_fraction = 0.9;
  // Log evidence that separates one place (a cell, an LED) from another: odds of 20 to 1.
  double min_log_odds_of_place = 3.0;
};

// Functions of a domain that check trials for the gates. Each is called for few trials.
struct Checks {
  // Structure of the trial's residuals of the fitted data (whiteness.h) [sigma].
  std::function<double(size_t trial)> excess_sigma;
  // Standard errors by which left-out segments are predicted better with the candidate at `which`
  // of the trial than without it. Nothing where there are too few segments; not set: not checked.
  std::function<std::optional<double>(size_t trial, size_t which)> gain_sigma = {};
  // Candidates of the same kind at other places, each in the place of the candidate at `which`,
  // with the log evidence by which it is behind; not set: there are no places.
  using Place = std::pair<size_t, double>;
  std::function<std::vector<Place>(size_t trial, size_t which)> other_places = {};
  GateLimits limits = {};
};

// A candidate that passed the gates.
struct Name {
  size_t candidate = 0;
  double probability = 0.0;  // that it acts, or an effect not distinguished from it
  std::optional<double> gain_sigma = {};
  std::vector<size_t> equal_places = {};  // candidates
};

struct Decision {
  Finding finding = Finding::nothing_missing;
  double confidence = 0.0;  // posterior probability of the finding and the names
  // Nothing is missing only because the difference has no name: fitted and held-out runs show it
  // together, neither does alone, and no candidate is much more likely than all others.
  bool undecided = false;
  // More is left beside the chosen model than noise.
  bool leaves_more = false;
  size_t chosen = 0;      // index of the trial whose model is kept
  size_t best_named = 0;  // of the best trial without empirical candidates; 0: nominal
  // Why something unknown acts, for a person: "the held-out recording is not predicted".
  std::string because = {};
  // Candidates of the chosen trial that act although the finding is unknown: beside a law without a
  // name, one at most, without which whatever else was tried is far less likely; and what several
  // explanations that are about as likely have in common.
  std::vector<size_t> beside_law = {};
  std::vector<double> probability;  // of each trial
  std::vector<Name> names = {};     // of the chosen trial where the finding is `named`
  // Whether the held-out data distinguish the chosen trial from the nominal model.
  bool held_out_tests_names = true;
};

// Trial 0 is the nominal model. `excess_sigma` is called for the best named trial. "Nothing is
// missing" has to predict the held-out data as well.
Decision decide(const std::vector<Explanation>& trials, const std::vector<CandidateTraits>& all,
                const Checks& checks, const Thresholds::Decision& limits);

}  // namespace photorque::inference
