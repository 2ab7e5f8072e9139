// Expected sizes of the candidates on machines other than platforms on air bearings.
#pragma once

#include "attitude/propagation/run.h"
#include "diagnosis/attitude/effects/trial.h"

namespace photorque {

// The scales of the catalogue are those of platforms on air bearings. For a bicycle wheel or a
// spacecraft they are wrong by many decades. For such machines the scale of every strength is set
// from the recorded rates: its torque over the recorded motion then equals the mean moment of
// inertia times the range of the rates over the duration. Platforms on air bearings and effects
// without a torque are unchanged.
void scale_to_machine(const NominalModel& nominal, const std::vector<Observation>& runs,
                      std::vector<Candidate>& candidates);

}  // namespace photorque
