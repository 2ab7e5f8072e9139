// `diagnose` for a module in sunlight: compares current-voltage curves with the undamaged module.
//
// The steps are: reference curves or a datasheet → one diode with its uncertainty → fit of every
// hypothesis to the recordings → evidence, with the held-out data → the decision of
// inference/decide.h. Light and temperature of each curve are nuisance parameters of the fits.
#pragma once

#include "diagnosis/diagnosis.h"
#include "diagnosis/light/module/design.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

struct ModuleDiagnoseOptions {
  int threads = 0;  // 0: all
  // Limit per curve; longer ones are thinned.
  size_t max_points = 160;
  Thresholds limits;
};

// Without holdouts every fourth segment of each curve is held out. Throws InputError for recordings
// other than curves. The result is independent of the number of threads.
Diagnosis diagnose_module(const ModuleDesign& design, const std::vector<LightRecording>& recordings,
                          const std::vector<LightRecording>& holdouts,
                          const ModuleDiagnoseOptions& options = {});

}  // namespace photorque
