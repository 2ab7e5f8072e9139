// Experiments that would tell apart what the recordings cannot.
#pragma once

#include "diagnosis/decide.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// One for every pair of an effect found and a kind that explains the recordings as well. Where the
// manoeuvre is another start of the first run, the lead that it would give the right kind is
// foretold: that run is flown by the chosen trial and its exact readings are fitted by the rival;
// half of the χ² that stays is the expected difference of log evidence.
std::vector<Manoeuvre> manoeuvres(const std::vector<FoundEffect>& effects, const Decision& decision,
                                  const std::vector<Trial>& trials,
                                  const std::vector<Candidate>& all,
                                  const std::vector<Observation>& runs);

}  // namespace photorque
