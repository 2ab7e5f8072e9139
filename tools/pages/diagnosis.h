// The page of `diagnose`: the verdict, what acts with its numbers, what was measured and what both
// models say of it, in the scene and as curves and maps.
#pragma once

#include "core/provenance.h"
#include "diagnosis/diagnosis.h"
#include "tools/pages/runs.h"

namespace photorque {

// Where the experiment has a scene with lamps, that scene; for motion without one an ellipsoid with
// the platform's moments of inertia; for curves of a module no scene at all. `of_light`: the
// recordings are scans, sweeps and runs of light instead of motion.
RunFile diagnosis_page(const Diagnosis& d, const Provenance& provenance, bool of_light,
                       const RunOptions& options, const PageHead& head);

}  // namespace photorque
