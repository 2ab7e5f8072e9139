// The answer to the curves of a module in words and numbers.
#pragma once

#include "diagnosis/diagnosis.h"
#include "diagnosis/light/module/explain.h"

namespace photorque {

std::string module_sentence(const Diagnosis& d);

// Without the sentence and the quality of the data.
Diagnosis described(const ModuleDesign& design, const ModuleNominal& nominal,
                    const ModuleAnswer& answer, const ModuleData& data, const Thresholds& limits);

// Curves that were diagnosed one by one, as one answer.
Diagnosis of_all_curves(std::vector<Diagnosis> each);

// Adds how the light of the curves goes with what a sensor saw: a line through the logarithm of
// their ratio over the order of the curves, by Theil and Sen, which a few curves under a cloud do
// not move. Without the irradiance of the reference the ratio counts from its median.
// `light`: of each curve over the reference.
void compare_with_sensor(const ModuleDesign& design, const std::vector<ModuleRun>& curves,
                         const std::vector<double>& light, Diagnosis& d);

// Warns of references that may contain the missing effects. A curve that is its own reference, and
// that no diode describes, is unexplained.
void judge_references(const ModuleDesign& design, const ModuleNominal& nominal,
                      const std::vector<LightRecording>& recordings, Diagnosis& d);

}  // namespace photorque
