// Whether the light of an experiment can be meant: found by a few rays.
#pragma once

#include <vector>

#include "core/errors.h"
#include "tools/runs/optical_run.h"

namespace photorque {

// One for each source that stands inside of a closed part or whose light misses the scene, and
// for each flux map that no light reaches at the experiment's attitude. Nothing for scenes with so
// many lamps that a few rays are many.
std::vector<InputError> light_mistakes(const OpticalRun& run);

}  // namespace photorque
