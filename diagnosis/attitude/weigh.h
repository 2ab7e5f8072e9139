// What the runs held out say about explanations that were found without them.
#pragma once

#include "diagnosis/attitude/trial.h"

namespace photorque {

struct HeldOut {
  const std::vector<Observation>& train;
  const std::vector<Observation>& held;
};

// How well the leaders also explain what was held out: their evidence on all runs together takes
// the place of that on the fitted ones. The others gain over the nominal model in the ratio of the
// best, and stay below the leaders. What only all runs together show, because one of them alone
// leaves it to the uncertainty of a nominal model, is screened for and added to `trials`, fitted to
// the train runs like all others. The nominal model comes first in `trials` and stays there.
void weigh_with_holdout(std::vector<Trial>& trials, const Candidates& all, const HeldOut& data,
                        int threads);

}  // namespace photorque
