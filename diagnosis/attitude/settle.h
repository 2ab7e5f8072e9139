// What is known of the readings before anything is explained: the nominal fit, outliers, the noise.
#pragma once

#include "attitude/estimation/nominal_model.h"
#include "diagnosis/attitude/recorded_data.h"

namespace photorque {

// The nominal model fitted. Readings that stand out are dropped on the way, and unless the
// experiment wants it as stated, the noise of `data` becomes what the readings show
// (attitude/observation/noise_search.h), after a drift of the gyro was taken out
// (gyro_bias.h); what was found is told in data.instruments. A model that cannot be propagated has
// infinite χ², and the noise stays as stated.
Fit settle(const NominalModel& nominal, const Thresholds& limits, RecordedData& data);

// Where the nominal model left the noise open, it is found about a model that comes near the
// readings. Returns whether it changed.
bool settle_again(const Fit& explained, const Thresholds& limits, RecordedData& data);

}  // namespace photorque
