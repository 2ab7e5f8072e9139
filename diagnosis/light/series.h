// Readings of light and power beside both models, for people to look at.
#pragma once

#include "diagnosis/diagnosis.h"
#include "diagnosis/light/account.h"

namespace photorque {

// Of runs voltage and current over time and the motion, of scans and sweeps every row.
RecordingSeries light_series(const LightAnswer& answer, const FittedRun& run, bool is_held_out);

}  // namespace photorque
