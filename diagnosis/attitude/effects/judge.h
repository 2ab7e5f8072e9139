// Evidence of a fitted model, and physical objections to it.
#pragma once

#include "diagnosis/attitude/effects/trial.h"

namespace photorque {

// Laplace's approximation of the evidence. The prior of the fit, which is far too wide, is replaced
// by one with the expected size of the effect.
double log_evidence(const Trial& trial, const Candidates& all);

// Sets the significance of each candidate of the trial, its evidence, and its physical objection.
void judge(Trial& trial, const Candidates& all);

// Whether a disturbance is a change of the inertia.
bool changes_inertia(const Disturbance& d);

}  // namespace photorque
