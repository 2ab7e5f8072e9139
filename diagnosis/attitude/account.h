// Findings as sentences and numbers for the reader of a diagnosis.
#pragma once

#include <string>

#include "core/transform.h"
#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

// Parameters of one key of which only the combination is identifiable.

// Of three numbers with their covariance (the squares of their unit), of which none is beyond twice
// its standard error: the principal combination that is furthest from zero in standard errors, its
// largest coefficient 1, as "x − 0.99 z = (4.4 ± 0.1)×10⁻¹⁰". Empty where none is beyond four, or
// where each number is identifiable.
std::string known_together(const Vec3& value, const Mat3& covariance);

// The effects of the chosen trial, each with the probability that its kind acts.
std::vector<FoundEffect> found_effects(const inference::Decision& decision,
                                       const std::vector<Trial>& trials, const Candidates& all);

// Those of them that act beyond doubt beside a law without a name.
std::vector<FoundEffect> effects_beside_law(const inference::Decision& decision,
                                            const std::vector<Trial>& trials,
                                            const Candidates& all);

// Those of the chosen trial that are not in `named`.
std::vector<FoundEffect> unnamed_effects(const inference::Decision& decision,
                                         const std::vector<Trial>& trials, const Candidates& all,
                                         const std::vector<FoundEffect>& named);

// Values and standard errors of one disturbance of a trial by key, in the keys' units, in the order
// of its law.
std::vector<FittedParameter> fitted_parameters(const Trial& trial, size_t disturbance);

// The best of every set of names, best first, relative to the nominal model.
std::vector<Alternative> alternatives(const inference::Decision& decision,
                                      const std::vector<Trial>& trials, const Candidates& all);

// One sentence for each nominal value that the recording contradicts.
std::vector<std::string> contradicted_beliefs(const Trial& chosen,
                                              const Thresholds::Decision& limits);
// Parameters with a prior, with their values in the chosen trial.
std::vector<FittedParameter> refined_priors(const Trial& chosen);
// An uncertain disturbance that no table of the experiment states, with its parameters in the
// chosen trial.
FoundEffect as_fitted(const Trial& chosen, size_t disturbance);

std::string sentence_of(const Diagnosis& diagnosis);

}  // namespace photorque
