// The verdict of a diagnosis from what the inference found.
#pragma once

#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

Verdict verdict_of(inference::Finding finding);

// The sentence where what was held out does not tell the names from the nominal model.
std::string untested_names(const Holdout& holdout);

}  // namespace photorque
