// The recordings of a diagnosis, made ready: what is fitted, what is held out, what was wrong.
#pragma once

#include "attitude/observation/observation.h"
#include "diagnosis/attitude/diagnose.h"

namespace photorque {

struct RecordedData {
  std::vector<Observation> train, held;
  int64_t outliers = 0;  // readings dropped
  std::vector<InstrumentFinding> instruments;
  bool noise_is_open = false;  // the nominal model is too far off to tell noise from motion
  std::vector<std::string> warnings;
};

// Conventions are checked; without holdouts the end of each recording is held out.
RecordedData read_data(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts, const DiagnoseOptions& options);

// What the files held.
DataQuality quality_of(const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts, const RecordedData& data);

}  // namespace photorque
