// Location of the differences between recording and nominal model: channels, intervals, band, and
// the variables on which they depend.
#pragma once

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// Misfit of each channel relative to noise; residuals that are not finite are omitted.
std::vector<Where::ChannelMisfit> misfits(const std::vector<Prediction>& residuals);

// `residuals` are those of the nominal model. `depends_on` remains empty.
Where locate(const std::vector<Prediction>& residuals, const std::vector<Observation>& runs,
             const Thresholds::Location& limits);

// For each variable, the fraction of the nominal model's misfit that an empirical law in it
// explains, largest first; small fractions are omitted. `trials` are those with one candidate,
// after the nominal model.
std::vector<Where::Dependence> dependences(const std::vector<Trial>& trials, const Candidates& all);

// Dependences for an unknown law: the variable of the chosen law comes first; at least one is
// returned.
std::vector<Where::Dependence> of_unknown_law(std::vector<Where::Dependence> depends_on,
                                              const Trial& chosen, const Candidates& all);

}  // namespace photorque
