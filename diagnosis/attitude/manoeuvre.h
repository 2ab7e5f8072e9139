// Proposed experiments that distinguish effects which the recordings do not.
#pragma once

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

// One manoeuvre for every pair of a found effect and a kind that is indistinguishable from it. The
// chosen trial predicts exact readings for four other initial states of the first run. The rival is
// fitted to these together with the existing recordings. Half of the growth of χ² is the expected
// lead in log evidence. The initial state with the largest lead is proposed.
std::vector<Manoeuvre> manoeuvres(const std::vector<FoundEffect>& effects,
                                  const inference::Decision& decision,
                                  const std::vector<Trial>& trials, const Candidates& all,
                                  const std::vector<Observation>& runs, int threads);

}  // namespace photorque
