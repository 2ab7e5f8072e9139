// Fits every hypothesis about a module to its curves, decides between them, and reports the result.
#pragma once

#include <utility>
#include <vector>

#include "diagnosis/diagnosis.h"
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

// report.cpp: the result for the curves of a module as sentences and numbers.

// One sentence that states the verdict, for the top of the report.
std::string module_sentence(const Diagnosis& d);

// The diagnosis without the sentence and the quality of the data.
Diagnosis described(const ModuleDesign& design, const ModuleNominal& nominal,
                    const ModuleAnswer& answer, const ModuleData& data, const Thresholds& limits);

// Combines diagnoses of single curves.
Diagnosis of_all_curves(std::vector<Diagnosis> each);

// Adds a comparison of the light of the curves with a sensor. A Theil-Sen line is fitted to the
// logarithm of their ratio over the order of the curves; it is robust to a few curves under a
// cloud. Without the irradiance of the reference the ratio is relative to its median. `light`:
// light of each curve relative to the reference.
void compare_with_sensor(const ModuleDesign& design, const std::vector<ModuleRun>& curves,
                         const std::vector<double>& light, Diagnosis& d);

// Warns of references that may contain the missing effects. If a curve is its own reference and no
// diode describes it, the verdict is "unexplained".
void judge_references(const ModuleDesign& design, const ModuleNominal& nominal,
                      const std::vector<LightRecording>& recordings, Diagnosis& d);

}  // namespace photorque
