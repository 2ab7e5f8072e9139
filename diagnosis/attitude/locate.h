// The place of the differences between recording and nominal model: channels, intervals, band, and
// the variables on which they depend.
#pragma once

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// How far residuals are from noise, channel by channel; those without a number are left out.
std::vector<Where::ChannelMisfit> misfits(const std::vector<Prediction>& residuals);

// `residuals` are those of the nominal model. `depends_on` is left empty.
Where locate(const std::vector<Prediction>& residuals, const std::vector<Observation>& runs,
             const Thresholds::Location& limits);

// From trials with one candidate: by each variable, the fraction of the misfit of the first trial
// (the nominal model) that an empirical law in it explains, largest first. Variables that explain
// little are left out.
std::vector<Where::Dependence> dependences(const std::vector<Trial>& trials, const Candidates& all);

// Dependences where the law is unknown: the variable of the chosen law comes first, and there is at
// least one.
std::vector<Where::Dependence> of_unknown_law(std::vector<Where::Dependence> depends_on,
                                              const Trial& chosen, const Candidates& all);

}  // namespace photorque
