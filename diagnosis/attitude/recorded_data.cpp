#include "diagnosis/attitude/recorded_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "attitude/estimation/columns.h"
#include "attitude/estimation/conventions.h"
#include "attitude/noise/reading_level.h"
#include "attitude/stretches/segments.h"
#include "core/constants.h"
#include "diagnosis/attitude/holdout.h"

namespace photorque {
namespace {

// What was said of a file's rows as it was cut.
void say_cuts(const std::string& name, const Segments& segments,
              std::vector<std::string>& warnings) {
  const auto say = [&](int64_t count, const char* what) {
    if (count > 0) warnings.push_back(name + ": " + std::to_string(count) + what);
  };
  say(segments.events,
      " rows with an event are left out, and the motion begins anew after each of them");
  say(segments.kinks,
      " rows where the rate changes at once, without an event noted, are left out, and the motion "
      "begins anew after each of them");
  say(segments.long_gaps, " long gaps: the motion begins anew after each of them");
  say(segments.too_short, " stretches with too few readings for a start of their own are left out");
  for (const std::string& why : segments.lawless) {
    warnings.push_back(name + ": " + why + ", which is left out");
  }
}

void say_unused(const NamedRecording& r, const Platform& platform,
                std::vector<std::string>& warnings) {
  std::string names;
  for (const std::string& column : MotionColumns(r.recording, platform, r.name).unused()) {
    names += (names.empty() ? "" : ", ") + column;
  }
  if (!names.empty()) warnings.push_back(r.name + ": columns that are not used: " + names);
}

// The stretches of each recording.
std::vector<std::vector<Observation>> observe_all(const std::vector<NamedRecording>& recordings,
                                                  const Platform& platform, size_t max_blocks,
                                                  std::vector<std::string>& warnings) {
  std::vector<std::vector<Observation>> all;
  for (const NamedRecording& r : recordings) {
    Segments segments = observe_segments(r.recording, r.name, platform, max_blocks);
    say_cuts(r.name, segments, warnings);
    say_unused(r, platform, warnings);
    std::string convention;
    for (Observation& seen : segments.all) {
      const std::string of_stretch =
          platform.has_bearing()
              ? repair_conventions(seen)
              : repair_conventions(seen) + repair_free_rates(seen, platform.inertia_kg_m2);
      if (convention.empty()) convention = of_stretch;
    }
    if (!convention.empty()) warnings.push_back(r.name + ": " + convention);
    all.push_back(std::move(segments.all));
  }
  return all;
}

void append_to(std::vector<Observation>& to, std::vector<Observation> from) {
  std::move(from.begin(), from.end(), std::back_inserter(to));
}

// The end of a recording in one piece; of one in many every fourth, so that what is held out saw
// the same times and conditions.
void hold_out(std::vector<Observation> stretches, double fraction, RecordedData& data) {
  const auto every = static_cast<size_t>(std::lround(1.0 / fraction));
  for (size_t i = 0; i < stretches.size(); ++i) {
    Observation& seen = stretches[i];
    if (stretches.size() >= every) {
      (i % every == every - 1 ? data.held : data.train).push_back(std::move(seen));
      continue;
    }
    const auto cut = static_cast<size_t>((1.0 - fraction) * static_cast<double>(seen.blocks()));
    data.held.push_back(seen.part(cut, seen.blocks()));
    data.train.push_back(seen.part(0, cut));
  }
}

// What the experiment states of its instruments. Where it states nothing and no second instrument
// tells what is motion, the readings themselves have to.
NoiseLevels noise_of(const Sensors& sensors, const std::vector<Observation>& runs,
                     std::vector<std::string>& warnings) {
  NoiseLevels noise = noise_levels(sensors);
  const bool can_be_found = runs.front().sees_attitude();
  for (int channel = 0; !can_be_found && channel < 6; ++channel) {
    if (channel < 3 ? states_camera_noise(sensors) : states_gyro_noise(sensors)) continue;
    const std::optional<double> level = reading_level(runs, channel);
    if (!level) continue;
    noise.set(channel, {*level, 0.0, 0.0});
    char text[200];
    std::snprintf(
        text, sizeof text,
        "%s: no noise is stated; neighbouring readings scatter by %.3g %s, which was used",
        channel_names[channel], channel < 3 ? *level / arcsecond_rad : *level,
        channel < 3 ? "arcsec" : "rad/s");
    warnings.emplace_back(text);
  }
  return noise;
}

}  // namespace

RecordedData read_data(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts,
                       const DiagnoseOptions& options) {
  const Platform& platform = nominal.model.platform;
  RecordedData data;
  for (auto& stretches : observe_all(recordings, platform, options.max_blocks, data.warnings)) {
    if (holdouts.empty()) {
      hold_out(std::move(stretches), options.holdout_fraction, data);
    } else {
      append_to(data.train, std::move(stretches));
    }
  }
  for (auto& stretches : observe_all(holdouts, platform, options.max_blocks, data.warnings)) {
    append_to(data.held, std::move(stretches));
  }
  const NoiseLevels noise = noise_of(nominal.sensors, data.train, data.warnings);
  for (auto* runs : {&data.train, &data.held}) {
    for (Observation& seen : *runs) seen.noise = noise;
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
