// A gyro whose bias drifts within a recording.
#pragma once

#include "diagnosis/attitude/recorded_data.h"

namespace photorque {

// Takes the drift out of the gyro's readings, their mean left as it is, and says so among the
// instruments. Nothing happens where a constant bias does for each recording.
void take_out_bias_drift(RecordedData& data);

}  // namespace photorque
