// The verdict on the trials of any domain. Every name passes the same gates:
//
//   (a) it, or an indistinguishable effect, is probable; otherwise it remains a candidate;
//   (b) each of its groups of parameters differs significantly from neutral. If every number is
//       within its error and only a combination is significant, no other explanation may be nearly
//       as good;
//   (c) segments that are left out of a fit are predicted better with it than without it;
//   (d) with all names the held-out χ² agrees with its prediction; otherwise: unknown. It is also
//       unknown if no name passes although some are far more likely than nothing;
//   (e) held-out data that the nominal model predicts as well do not test the names;
//   (f) all places that explain the data equally well are listed.
#pragma once

#include <functional>
#include <utility>

#include "inference/domain.h"

namespace photorque::inference {

enum class Verdict {
  consistent,       // differences are noise, or within the stated uncertainty
  missing_physics,  // the named candidates explain the differences
  unexplained,      // residual structure remains, or only an empirical candidate explains it
};

// Limits of the gates in addition to Thresholds::Decision.
struct GateLimits {
  // Minimum gain in the prediction of left-out segments by a name [standard errors].
  double min_gain_sigma = 3.0;
  // Ratio of the held-out χ² to that of the nominal model above which the data do not test a name.
  double max_untested_fraction = 0.9;
  // Log evidence that distinguishes one place (a cell, an LED) from another: odds of 20 to 1.
  double min_log_odds_of_place = 3.0;
};

// Functions of a domain that evaluate trials for the gates. Each is called for few trials.
struct Checks {
  // Residual structure of the trial in the fitted data (whiteness.h) [sigma].
  std::function<double(size_t trial)> excess_sigma;
  // Gain in the prediction of left-out segments by the candidate at `which` [standard errors].
  // Nothing: too few segments. Not set: gate (c) is skipped.
  std::function<std::optional<double>(size_t trial, size_t which)> gain_sigma = {};
  // Candidates of the same kind at other places, each as a replacement for the candidate at
  // `which`, with its deficit in log evidence. If not set, the domain has no places.
  using Place = std::pair<size_t, double>;
  std::function<std::vector<Place>(size_t trial, size_t which)> other_places = {};
  GateLimits limits = {};
};

// A candidate that passed the gates.
struct Name {
  size_t candidate = 0;
  double probability = 0.0;  // probability of this effect or an indistinguishable one
  std::optional<double> gain_sigma = {};
  std::vector<size_t> equal_places = {};  // candidates at other places
};

struct Decision {
  Verdict verdict = Verdict::consistent;
  double confidence = 0.0;  // posterior probability of the verdict and the names
  // The verdict is "consistent" although the data differ from the nominal model. Fitted and
  // held-out runs show the difference only together, and no candidate is much more likely than the
  // others.
  bool undecided = false;
  // Residual structure remains after the chosen model.
  bool leaves_more = false;
  size_t chosen = 0;      // index of the trial whose model is reported
  size_t best_named = 0;  // index of the best trial without empirical candidates; 0: nominal
  // Reason for the verdict "unexplained", as text: "the model does not predict the held-out
  // recording".
  std::string because = {};
  // Candidates of the chosen trial that are certain although the verdict is unexplained. With an
  // empirical law: at most one, without which all other explanations are far less likely. With
  // several about equally likely explanations: the candidates that they have in common.
  std::vector<size_t> beside_law = {};
  std::vector<double> probability;  // one per trial
  std::vector<Name> names = {};     // names of the chosen trial if the verdict is `missing_physics`
  // Whether the held-out data distinguish the chosen trial from the nominal model.
  bool held_out_tests_names = true;
};

// Gate (b): whether every candidate that has a size (NaN: it has none) differs from neutral.
bool is_significant(const std::vector<double>& significance, const Thresholds::Decision& limits);

// Gate (b) for a trial, on fitted and held-out data together where it has been fitted to both.
bool is_significant(const Explanation& trial, const Thresholds::Decision& limits);

// Whether the trial contains the candidate, and it differs from neutral by all its numbers together
// and by one of them alone: the condition for a name beside an empirical law.
bool is_clear(const Explanation& trial, size_t candidate, const Thresholds::Decision& limits);

// Decides between the trials of a domain. Trial 0 is the nominal model. `all` are the candidates.
// `excess_sigma` is called for the best named trial. The verdict "consistent" requires that
// the nominal model also predicts the held-out data.
Decision decide(const std::vector<Explanation>& trials, const std::vector<CandidateTraits>& all,
                const Checks& checks, const Thresholds::Decision& limits);

}  // namespace photorque::inference
