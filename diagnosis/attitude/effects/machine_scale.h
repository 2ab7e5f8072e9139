// The sizes to be expected of effects on a machine that is no table-top platform.
#pragma once

#include <vector>

#include "diagnosis/attitude/effects/trial.h"

namespace photorque {

// The catalogue's sizes are those of platforms on air bearings. On a bicycle wheel or a spacecraft
// they are wrong by many decades either way: there the size of every strength is set so that its
// torque, over the recorded motion, is what changes the recorded rates: the mean moment of inertia
// times the range of the rates over the duration. Does nothing for a platform on an air bearing,
// nor to what exerts no torque.
void scale_to_machine(const NominalModel& nominal, const std::vector<Observation>& runs,
                      std::vector<Candidate>& candidates);

}  // namespace photorque
