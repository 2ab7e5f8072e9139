// What a fitted empirical law says, as numbers against its variable.
#pragma once

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// The empirical parts of a trial along its first run: means over bins of the variable, with the
// standard errors that follow from the covariance of the law's coefficients.
std::vector<EmpiricalTorque> empirical_torques(const Trial& chosen, const Candidates& all,
                                               const std::vector<Observation>& runs);

}  // namespace photorque
