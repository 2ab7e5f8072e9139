// Puts what was found into words and numbers for the reader of a diagnosis.
#pragma once

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

// The effects of the chosen trial, each with the probability that its kind acts.
std::vector<FoundEffect> found_effects(const inference::Decision& decision,
                                       const std::vector<Trial>& trials, const Candidates& all);

// The best of every set of names, best first, relative to the nominal model.
std::vector<Alternative> alternatives(const inference::Decision& decision,
                                      const std::vector<Trial>& trials, const Candidates& all);

// What was nominal with an uncertainty, as the chosen trial has it.
std::vector<FittedParameter> refined_priors(const Trial& chosen);

std::string sentence_of(const Diagnosis& diagnosis);

}  // namespace photorque
