// Plausibility test of the light of an experiment with a few rays.
#pragma once

#include <vector>

#include "core/errors.h"
#include "tools/runs/optical_run.h"

namespace photorque {

// One error for each source inside a closed part, for each source whose light misses the scene, and
// for each flux map without light at the experiment's attitude. Empty for scenes with too many
// lamps for a quick test.
std::vector<InputError> unlit_receiver_errors(const OpticalRun& run);

}  // namespace photorque
