// Findings of a diagnosis as sentences and numbers.
#pragma once

#include <string>

#include "core/transform.h"
#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

// For three values with their covariance (in the squared unit), each within twice its standard
// error: the principal combination that is furthest from zero in standard errors. Its largest
// coefficient is scaled to 1, as "x − 0.99 z = (4.4 ± 0.1)×10⁻¹⁰". Empty if no combination exceeds
// four standard errors, or if a single value exceeds two.
std::string known_together(const Vec3& value, const Mat3& covariance);

// The effects of the chosen trial, each with the probability of its kind.
std::vector<FoundEffect> found_effects(const inference::Decision& decision,
                                       const std::vector<Trial>& trials, const Candidates& all);

// Effects that are certain although an empirical law describes the residual.
std::vector<FoundEffect> effects_beside_law(const inference::Decision& decision,
                                            const std::vector<Trial>& trials,
                                            const Candidates& all);

// Effects of the chosen trial that are not in `named`.
std::vector<FoundEffect> unnamed_effects(const inference::Decision& decision,
                                         const std::vector<Trial>& trials, const Candidates& all,
                                         const std::vector<FoundEffect>& named);

// Values and standard errors of one disturbance of a trial, by key, in the units of the keys and in
// the order of the law.
std::vector<FittedParameter> fitted_parameters(const Trial& trial, size_t disturbance);

// The best trial of every set of names, best first, relative to the nominal model.
std::vector<Alternative> alternatives(const inference::Decision& decision,
                                      const std::vector<Trial>& trials, const Candidates& all);

// One sentence for each nominal value that the recording contradicts.
std::vector<std::string> contradicted_priors(const Trial& chosen,
                                             const Thresholds::Decision& limits);
// Parameters with a prior, with their values in the chosen trial.
std::vector<FittedParameter> refined_priors(const Trial& chosen);
// An uncertain disturbance with its parameters in the chosen trial, for an experiment that has no
// table for it.
FoundEffect as_fitted(const Trial& chosen, size_t disturbance);

// One sentence that states the verdict, for the top of the report.
std::string sentence_of(const Diagnosis& diagnosis);

}  // namespace photorque
