// The prepared recordings of a diagnosis: fitted data, held-out data, rejected readings.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "attitude/estimation/fit.h"
#include "attitude/observation/observation.h"
#include "attitude/propagation/run.h"
#include "diagnosis/attitude/diagnose.h"

namespace photorque {

struct RecordedData {
  std::vector<Observation> train, held;
  int64_t outliers = 0;  // number of dropped readings
  std::vector<InstrumentFinding> instruments;
  bool noise_is_open = false;  // the nominal model fits too badly to separate noise from motion
  // The noise before it was estimated about the nominal model; empty: it is as stated.
  std::optional<NoiseLevels> noise_before;
  std::vector<std::string> warnings;
};

// Calls `action` with every fitted and held-out run.
template <class Data, class Action>
void for_each_run(Data& data, const Action& action) {
  for (auto* runs : {&data.train, &data.held}) std::ranges::for_each(*runs, action);
}

// Sets the noise of all runs, or of one channel of all runs.
void set_noise(const NoiseLevels& noise, RecordedData& data);
void set_noise(int channel, const ChannelNoise& noise, RecordedData& data);

// Checks conventions and reads the data; without holdouts the last quarter of each recording is
// held out.
RecordedData read_data(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts, const DiagnoseOptions& options);

// Rows, rejected readings and gaps of the files.
DataQuality quality_of(const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts, const RecordedData& data);

// Fits the nominal model and drops outliers. Unless the experiment requires the stated noise, the
// noise of `data` is estimated from the readings (attitude/observation/noise_search.h) after
// removal of a gyro drift (subtract_bias_drift()). Both are reported in data.instruments. A model
// that cannot be propagated has infinite χ², and the noise remains as stated.
Fit settle(const NominalModel& nominal, const Thresholds& limits, RecordedData& data);

// Estimates the noise about an explanation near the readings if the nominal model left it
// undetermined. Noise that was estimated about the nominal model may contain effects that the model
// lacks. It is replaced if the readings are quieter or less correlated about the explanation.
// Returns whether the noise changed.
bool estimate_noise_again(const Fit& explained, const Thresholds& limits, RecordedData& data);

// Removes the drift from the gyro readings, keeps their mean, and reports it among the instruments.
// Does nothing if a constant bias per recording suffices.
void subtract_bias_drift(RecordedData& data);

// Propagates a fitted model along other runs. Only initial conditions (initial state, instrument
// biases within their stated uncertainty) are fitted to them.
Fit propagate_model(const Fit& fitted, const std::vector<Observation>& runs,
                    const Thresholds& limits);

}  // namespace photorque
