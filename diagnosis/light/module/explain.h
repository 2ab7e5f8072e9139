// Fits every hypothesis about a module to its curves, and decides between them.
#pragma once

#include <utility>
#include <vector>

#include "diagnosis/light/module/fit.h"
#include "inference/decide.h"

namespace photorque {

struct ModuleData {
  std::vector<ModuleRun> train, held;
  std::vector<ModuleRun> whole;  // every curve with all its points
};

struct ModuleAnswer {
  std::vector<ModuleHypothesis> hypotheses;
  // To the curves for training, and to all; ModuleTrial::log_evidence is that of all.
  std::vector<ModuleTrial> trials, joint;
  inference::Decision decision;
};

// Log evidence behind the best from which a hypothesis is hopeless.
inline constexpr double hopeless_log_evidence = 60.0;

// The points for training and the held-out ones: every fourth segment, each a fortieth of the
// curve.
std::pair<ModuleRun, ModuleRun> split_curve(const ModuleRun& run);

// `hypotheses`: the first is that nothing is missing. The same result for any number of threads.
ModuleAnswer explain_module(const ModuleDesign& design, const ModuleNominal& nominal,
                            const std::vector<ModuleHypothesis>& hypotheses, const ModuleData& data,
                            int threads, const Thresholds& limits);

}  // namespace photorque
