// `diagnose` for a module in sunlight: current-voltage curves against the module as it was.
//
// Reference curves or a datasheet → one diode with its uncertainty → every hypothesis fitted to the
// recordings, with light and temperature of each curve as its nuisances → evidence, with the
// held-out data → the decision of inference/decide.h.
#pragma once

#include "diagnosis/diagnosis.h"
#include "diagnosis/light/module/design.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

struct ModuleDiagnoseOptions {
  int threads = 0;  // 0: all
  // Of each curve: of longer ones every so many points are used.
  size_t max_points = 160;
  Thresholds limits;
};

// Without holdouts every fourth segment of each curve is held out. InputError for recordings that
// are no curves. The same result for any number of threads.
Diagnosis diagnose_module(const ModuleDesign& design, const std::vector<LightRecording>& recordings,
                          const std::vector<LightRecording>& holdouts,
                          const ModuleDiagnoseOptions& options = {});

}  // namespace photorque
