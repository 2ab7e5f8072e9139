// The verdict: from the evidence of all trials, what is forbidden, and whether noise is left.
#pragma once

#include <functional>

#include "inference/domain.h"

namespace photorque::inference {

enum class Finding {
  nothing_missing,  // what differs is noise
  named,            // the candidates named explain what differs
  unknown,          // structure is left after them, or only an empirical candidate takes it up
};

struct Decision {
  Finding finding = Finding::nothing_missing;
  double confidence = 0.0;  // posterior probability of the finding and the names
  // Nothing missing only because what shows has no name: the runs and what was held out show it
  // together, neither does alone, and no candidate is much likelier than all others.
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
};

// Trial 0 is the nominal model. `excess_sigma` is asked for the best named trial, and is the
// structure that it leaves. Whatever is said has to predict what was held out, "nothing is missing"
// as well, and every name has to be missed where it is taken away.
Decision decide(const std::vector<Explanation>& trials, const std::vector<CandidateTraits>& all,
                const std::function<double(size_t trial)>& excess_sigma,
                const Thresholds::Decision& limits);

}  // namespace photorque::inference
