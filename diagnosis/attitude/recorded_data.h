// The prepared recordings of a diagnosis: fitted data, held-out data, rejected readings.
#pragma once

#include <cstdio>
#include <string>

#include "attitude/estimation/fit.h"
#include "attitude/observation/observation.h"
#include "attitude/propagation/run.h"
#include "diagnosis/attitude/diagnose.h"

namespace photorque {

// A sentence with numbers in it, as printf writes it; at most 499 characters.
template <typename... Values>
std::string written(const char* format, Values... values) {
  char text[500];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

struct RecordedData {
  std::vector<Observation> train, held;
  int64_t outliers = 0;  // readings dropped
  std::vector<InstrumentFinding> instruments;
  bool noise_is_open = false;  // the nominal model is too far off to separate noise from motion
  std::vector<std::string> warnings;
};

// Conventions are checked; without holdouts the end of each recording is held out.
RecordedData read_data(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts, const DiagnoseOptions& options);

// Rows, rejected readings and gaps of the files.
DataQuality quality_of(const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts, const RecordedData& data);

// Fits the nominal model. Outliers are dropped on the way. Unless the experiment requires the
// stated noise, the noise of `data` becomes that of the readings
// (attitude/observation/noise_search.h), after a drift of the gyro was taken out
// (take_out_bias_drift()); both are reported in data.instruments. A model that cannot be propagated
// has infinite χ², and the noise stays as stated.
Fit settle(const NominalModel& nominal, const Thresholds& limits, RecordedData& data);

// Finds the noise that the nominal model left open, about a model that comes near the readings.
// Returns whether it changed.
bool settle_again(const Fit& explained, const Thresholds& limits, RecordedData& data);

// A gyro whose bias drifts within a recording.

// Removes the drift from the gyro's readings, keeps their mean, and reports it among the
// instruments. Does nothing where a constant bias for each recording suffices.
void take_out_bias_drift(RecordedData& data);

}  // namespace photorque
