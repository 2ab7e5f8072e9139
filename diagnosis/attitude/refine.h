// Refinement of an empirical torque over time when no known effect explains it.
#pragma once

#include "diagnosis/attitude/effects/trial.h"

namespace photorque {

// The laws in time that compete with physics are few and coarse, so that they cost little if a
// known effect acts. This function refines the chosen one by a smooth table over the recording and
// by a periodic torque whose period comes from the table. Returns the trial of largest evidence,
// possibly `chosen`, and adds its candidate to `all`.
Trial refined_in_time(const Trial& chosen, Candidates& all, const std::vector<Observation>& runs);

}  // namespace photorque
