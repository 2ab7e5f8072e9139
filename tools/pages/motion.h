// The page of `propagate`: the platform as it moves, played over time.
#pragma once

#include "tools/coupling/propagate.h"
#include "tools/pages/runs.h"

namespace photorque {

// Where the experiment has a scene, that scene, with its light traced at some instants of the run;
// otherwise an ellipsoid with the platform's moments of inertia.
RunFile motion_page(const MotionRun& run, const RunOptions& options, const PageHead& head);

}  // namespace photorque
