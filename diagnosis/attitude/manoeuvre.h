// Proposed experiments that distinguish effects which the recordings do not distinguish.
#pragma once

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

// One for every pair of an effect found and a kind that explains the recordings as well. Of four
// other starts of the first run, each is propagated by the chosen trial, and the rival is fitted to
// its exact readings together with the recordings that there are: half of what χ² gains is the
// expected lead in log evidence. The start with the largest is proposed.
std::vector<Manoeuvre> manoeuvres(const std::vector<FoundEffect>& effects,
                                  const inference::Decision& decision,
                                  const std::vector<Trial>& trials, const Candidates& all,
                                  const std::vector<Observation>& runs, int threads);

}  // namespace photorque
