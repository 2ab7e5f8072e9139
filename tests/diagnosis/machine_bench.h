// Machines by their experiment, recordings by their channels.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/attitude/diagnose.h"
#include "scenes/experiment/toml.h"
#include "tests/diagnosis/named.h"

namespace photorque {

inline NominalModel machine(const std::string& toml) {
  return read_attitude_model(
      Settings(std::make_shared<const SettingsNode>(parse_toml(toml, "machine.toml"))));
}

// Rows of named channels at even times.
inline Recording recording_of(double interval_s, const std::vector<Channel>& channels) {
  Recording recording;
  recording.channels = channels;
  const size_t rows = channels.front().values.size();
  for (size_t i = 0; i < rows; ++i) recording.time_s.push_back(interval_s * static_cast<double>(i));
  recording.report.rows_read = recording.report.rows_kept = static_cast<int64_t>(rows);
  recording.report.median_interval_s = interval_s;
  return recording;
}

}  // namespace photorque
