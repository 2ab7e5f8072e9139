// The result for the curves of a module as sentences and numbers.
#pragma once

#include "diagnosis/diagnosis.h"
#include "diagnosis/light/module/explain.h"

namespace photorque {

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
