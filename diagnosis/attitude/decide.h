// The verdict: from the evidence of all trials, what physics allows, and whether noise is left.
#pragma once

#include "diagnosis/attitude/trial.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

struct Decision {
  Verdict verdict = Verdict::consistent;
  double confidence = 0.0;  // posterior probability of the verdict and the names
  // Consistent only because the effect that shows has no name: the recordings and what was held
  // back show it together, neither does alone, and no candidate is much likelier than all others.
  bool undecided = false;
  size_t chosen = 0;   // index of the trial whose model is kept
  size_t physics = 0;  // index of the best trial of physics alone (0: the nominal model)
  std::vector<double> probability;  // of each trial
};

// Trial 0 is the nominal model.
Decision decide(const std::vector<Trial>& trials, const Candidates& all,
                const std::vector<Observation>& runs);

}  // namespace photorque
