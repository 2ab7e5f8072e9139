// Evidence of a fitted model, and physical objections to it.
#pragma once

#include "diagnosis/attitude/effects/trial.h"

namespace photorque {

// Laplace's approximation of the evidence. The fit's own prior is far wider than the nominal model
// of an effect; here it is replaced by the expected size of an effect.
double log_evidence(const Trial& trial, const Candidates& all);

// States the significance of each of the trial's candidates, its evidence, and the objection to it.
void judge(Trial& trial, const Candidates& all);

// Whether a kind enters as a change of the inertia.
bool changes_inertia(const Disturbance& d);

}  // namespace photorque
