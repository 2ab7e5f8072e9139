// `diagnose` for a module in sunlight: compares current-voltage curves with the undamaged module.
//
// The steps are: reference curves or a datasheet → one diode with its uncertainty → fit of every
// hypothesis to the recordings → evidence, with the held-out data → the decision of
// inference/decide.h. Light and temperature of each curve are nuisance parameters of the fits.
#pragma once

#include "diagnosis/diagnosis.h"
#include "diagnosis/light/module/design.h"

namespace photorque {

// Without holdouts every fourth segment of each curve is held out. Throws InputError for recordings
// other than curves. `threads`: 0 for all; the result is independent of them.
Diagnosis diagnose_module(const ModuleDesign& design, const std::vector<LightRecording>& recordings,
                          const std::vector<LightRecording>& holdouts, int threads = 0);

}  // namespace photorque
