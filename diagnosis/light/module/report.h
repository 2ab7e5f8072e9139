// The result for the curves of a module as sentences and numbers.
#pragma once

#include "diagnosis/diagnosis.h"
#include "diagnosis/light/module/explain.h"

namespace photorque {

std::string module_sentence(const Diagnosis& d);

// The diagnosis without the sentence and the quality of the data.
Diagnosis described(const ModuleDesign& design, const ModuleNominal& nominal,
                    const ModuleAnswer& answer, const ModuleData& data, const Thresholds& limits);

// Combines diagnoses of single curves.
Diagnosis of_all_curves(std::vector<Diagnosis> each);

// Adds a comparison of the light of the curves with a sensor: a Theil-Sen line through the
// logarithm of their ratio over the order of the curves, which is robust to a few curves under a
// cloud. Without the irradiance of the reference the ratio is relative to its median. `light`: of
// each curve relative to the reference.
void compare_with_sensor(const ModuleDesign& design, const std::vector<ModuleRun>& curves,
                         const std::vector<double>& light, Diagnosis& d);

// Warns of references that may contain the missing effects. A curve that is its own reference, and
// that no diode describes, is unexplained.
void judge_references(const ModuleDesign& design, const ModuleNominal& nominal,
                      const std::vector<LightRecording>& recordings, Diagnosis& d);

}  // namespace photorque
