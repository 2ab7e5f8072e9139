// Fits every hypothesis about a module to its curves and decides between them.
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
  // Fits to the training data and to all data. The decision compares the log evidence of the
  // latter.
  std::vector<ModuleTrial> trials, joint;
  inference::Decision decision;
};

// Deficit in log evidence to the best above which a hypothesis is hopeless.
inline constexpr double hopeless_log_evidence = 60.0;

// Splits a curve into training and held-out points: every fourth segment, each a fortieth of the
// curve, is held out.
std::pair<ModuleRun, ModuleRun> split_curve(const ModuleRun& run);

// The first of `hypotheses` is "nothing missing". The result is independent of the number of
// threads.
ModuleAnswer explain_module(const ModuleDesign& design, const ModuleNominal& nominal,
                            const std::vector<ModuleHypothesis>& hypotheses, const ModuleData& data,
                            int threads, const Thresholds& limits);

}  // namespace photorque
