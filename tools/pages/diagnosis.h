// The page of `diagnose`: the verdict, what acts with its numbers, what was measured and what both
// models say of it, in the scene and as curves and maps.
#pragma once

#include "tools/pages/runs.h"
#include "tools/tasks/diagnose.h"

namespace photorque {

// Where the experiment has a scene with lamps, that scene; for motion without one an ellipsoid with
// the platform's moments of inertia; for curves of a module no scene at all.
RunFile diagnosis_page(const DiagnosisRun& run, const RunOptions& options, const PageHead& head);

}  // namespace photorque
