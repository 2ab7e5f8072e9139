#include "diagnosis/attitude/recorded_data.h"

#include <algorithm>

#include "attitude/estimation/conventions.h"

namespace photorque {
namespace {

std::vector<Observation> observe_all(const std::vector<NamedRecording>& recordings,
                                     const NoiseLevels& noise, size_t max_blocks,
                                     std::vector<std::string>& warnings) {
  std::vector<Observation> all;
  for (const NamedRecording& r : recordings) {
    all.push_back(observe(r.recording, r.name, max_blocks));
    all.back().noise = noise;
    const std::string convention = repair_conventions(all.back());
    if (!convention.empty()) warnings.push_back(r.name + ": " + convention);
  }
  return all;
}

}  // namespace

RecordedData read_data(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts,
                       const DiagnoseOptions& options) {
  const NoiseLevels noise = noise_levels(nominal.sensors);
  RecordedData data;
  data.train = observe_all(recordings, noise, options.max_blocks, data.warnings);
  data.held = observe_all(holdouts, noise, options.max_blocks, data.warnings);
  if (!data.held.empty()) return data;
  for (Observation& seen : data.train) {
    const auto cut =
        static_cast<size_t>((1.0 - options.holdout_fraction) * static_cast<double>(seen.blocks()));
    data.held.push_back(seen.part(cut, seen.blocks()));
    seen = seen.part(0, cut);
  }
  return data;
}

DataQuality quality_of(const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts, const RecordedData& data) {
  DataQuality q;
  for (const auto* group : {&recordings, &holdouts}) {
    for (const NamedRecording& r : *group) {
      const RecordingReport& report = r.recording.report;
      q.rows += report.rows_read;
      q.used += report.rows_kept;
      q.rejected["malformed_row"] += report.malformed_rows;
      q.rejected["no_time"] += report.rows_without_time;
      q.rejected["repeated_time"] += report.repeated_times;
      q.rejected["backward_time"] += report.backward_times;
      q.rejected["outlier"] += report.outlier_cells;
      q.rejected["gap"] += static_cast<int64_t>(report.gaps.size());
      q.rejected["empty_cell"] += report.empty_cells;
      q.rejected["unreadable_cell"] += report.unreadable_cells;
      q.rejected["bad_quaternion"] += report.bad_quaternions;
      q.repaired["flipped_quaternion"] += report.flipped_quaternions;
      for (const RecordingReport::Gap& gap : report.gaps) {
        q.max_gap_s = std::max(q.max_gap_s, gap.to_s - gap.from_s);
      }
    }
  }
  q.rejected["outlier"] += data.outliers;
  q.median_interval_s = recordings.front().recording.report.median_interval_s;
  q.jitter_s = recordings.front().recording.report.jitter_s;
  return q;
}

}  // namespace photorque
