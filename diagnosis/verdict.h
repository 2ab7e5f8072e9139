// The verdict of a diagnosis from the finding of the inference.
#pragma once

#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

Verdict verdict_of(inference::Finding finding);

// Sentence for held-out data that do not distinguish the named effects from the nominal model.
std::string untested_names(const Holdout& holdout);

}  // namespace photorque
