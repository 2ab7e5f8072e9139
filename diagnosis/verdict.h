// The verdict of a diagnosis from the findings of the inference.
#pragma once

#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

Verdict verdict_of(inference::Finding finding);

// The sentence where the held-out data do not distinguish the named effects from the nominal model.
std::string untested_names(const Holdout& holdout);

}  // namespace photorque
