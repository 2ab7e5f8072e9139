// A torque that depends on time, once it is sure that nothing known explains it.
#pragma once

#include "diagnosis/attitude/effects/trial.h"

namespace photorque {

// The laws in time that compete with physics are few and coarse, so that they cost little where
// something known acts. Here the one that was chosen is followed in more detail: by a smooth table
// over the recording, and by a torque with a period, which that table suggests. What has the
// largest evidence is returned (the trial itself where that is it), its candidate added to `all`.
Trial refined_in_time(const Trial& chosen, Candidates& all, const std::vector<Observation>& runs);

}  // namespace photorque
