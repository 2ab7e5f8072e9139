// The verdict of a diagnosis from what the inference found.
#pragma once

#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

Verdict verdict_of(inference::Finding finding);

}  // namespace photorque
