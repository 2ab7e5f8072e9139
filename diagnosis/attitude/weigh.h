// What the runs held back say about explanations that were found without them.
#pragma once

#include "diagnosis/attitude/trial.h"

namespace photorque {

struct HeldBack {
  const std::vector<Observation>& train;
  const std::vector<Observation>& held;
};

// How well the leaders also explain what was held back: their evidence on all runs together takes
// the place of that on the fitted ones. The others gain over the belief in the ratio of the best,
// and stay below the leaders. What only all runs together show, because one of them alone leaves it
// to the uncertainty of a belief, is screened for and added to `trials`, fitted to the train runs
// like all others. The belief comes first in `trials` and stays there.
void weigh_with_holdout(std::vector<Trial>& trials, const std::vector<Candidate>& all,
                        const HeldBack& data, int threads);

}  // namespace photorque
