#include "diagnosis/attitude/recorded_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "attitude/estimation/conventions.h"
#include "attitude/estimation/segments.h"
#include "attitude/observation/noise_levels.h"
#include "attitude/recordings/channels.h"
#include "attitude/recordings/columns.h"
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

// An accelerometer and a magnetometer count where the experiment has them: where the one sits, and
// that nothing aboard disturbs the other, is nothing that a recording says.
bool is_declared(const Sensors& sensors, int scalar) {
  const Measures measures = channel_traits(vector_channels + scalar).measures;
  if (measures == Measures::force) return sensors.accelerometer.has_value();
  return measures != Measures::field || sensors.magnetometer.has_value();
}

void say_unused(const NamedRecording& r, const NominalModel& nominal,
                const std::set<std::string>& read_elsewhere, std::vector<std::string>& warnings) {
  const Platform& platform = nominal.model.platform;
  std::string names, undeclared;
  const MotionColumns motion(r.recording, platform, r.name);
  for (int s = first_field; s < first_place; ++s) {
    if (is_declared(nominal.sensors, s) || !motion.has_scalar(static_cast<Scalar>(s))) continue;
    undeclared +=
        (undeclared.empty() ? "" : ", ") + std::string(channel_traits(vector_channels + s).column);
  }
  if (!undeclared.empty()) {
    warnings.push_back(r.name + ": " + undeclared +
                       " are not compared: the experiment has no [sensors.accelerometer] or "
                       "[sensors.magnetometer] for them");
  }
  for (const std::string& column : motion.unused()) {
    if (read_elsewhere.contains(column)) continue;
    names += (names.empty() ? "" : ", ") + column;
  }
  if (!names.empty()) warnings.push_back(r.name + ": columns that are not used: " + names);
}

// Without rates nothing tells in which sequence angles are turned.
void say_assumed_sequence(const NamedRecording& r, const Platform& platform,
                          std::vector<std::string>& warnings) {
  const MotionColumns columns(r.recording, platform, r.name);
  if (!columns.has_angles() || columns.has_gyro() || !r.recording.angle_sequence.empty()) return;
  warnings.push_back(r.name + ": roll, pitch and yaw are taken in the sequence zyx, " +
                     formula_of(angle_sequences[0]) +
                     "; no rates are there to test it, and [recording] angle_sequence states it");
}

// The stretches of each recording.
std::vector<std::vector<Observation>> observe_all(const std::vector<NamedRecording>& recordings,
                                                  const NominalModel& nominal,
                                                  const DiagnoseOptions& options,
                                                  std::vector<std::string>& warnings) {
  const Platform& platform = nominal.model.platform;
  std::vector<std::vector<Observation>> all;
  for (const NamedRecording& r : recordings) {
    refuse_jump_of_clock(r.recording, r.name);
    Segments segments = observe_segments(r.recording, r.name, platform, options.max_blocks);
    say_cuts(r.name, segments, warnings);
    say_unused(r, nominal, options.read_elsewhere, warnings);
    say_assumed_sequence(r, platform, warnings);
    if (MotionColumns(r.recording, platform, r.name).has_scalar(Scalar::tilt)) {
      warnings.push_back(r.name +
                         ": a tilt does not say whereto the body leans: an answer has a mirror "
                         "image that reads the same, leaning the other way, and priors alone "
                         "decide between them; signs of what is found may be those of the image");
    }
    std::string convention = segments.angles ? segments.angles->text : "";
    for (Observation& seen : segments.all) {
      for (int s = 0; s < scalar_count; ++s) {
        if (!is_declared(nominal.sensors, s)) seen.scalar[static_cast<size_t>(s)] = {};
      }
      seen.fields = field_instruments(nominal.sensors);
    }
    std::string of_rates = repair_conventions(segments.all);
    if (!platform.has_bearing())
      of_rates += repair_free_rates(segments.all, platform.inertia_kg_m2);
    if (convention.empty()) convention = of_rates;
    if (!convention.empty()) warnings.push_back(r.name + ": " + convention);
    all.push_back(std::move(segments.all));
  }
  return all;
}

void append_to(std::vector<Observation>& to, std::vector<Observation> from) {
  std::move(from.begin(), from.end(), std::back_inserter(to));
}

// The block from which on this fraction of the blocks lies that read something of the motion.
size_t cut_at(const Observation& seen, double fraction) {
  std::vector<size_t> reading;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    bool any = false;
    for (int channel = 0; channel < channel_count; ++channel) {
      any = any || seen.rows_of(i, channel) > 0.0;
    }
    if (any) reading.push_back(i);
  }
  const double kept = 1.0 - fraction;
  const auto of = [&](size_t count) {
    return static_cast<size_t>(kept * static_cast<double>(count));
  };
  return reading.empty() ? of(seen.blocks()) : reading[of(reading.size())];
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
    const size_t cut = cut_at(seen, fraction);
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
  for (int channel = 0; !can_be_found && channel < channel_count; ++channel) {
    if (states_noise(sensors, channel)) continue;
    const std::optional<double> level = reading_level(runs, channel);
    if (!level) continue;
    noise.set(channel, {*level, 0.0, 0.0});
    char text[200];
    std::snprintf(
        text, sizeof text,
        "%s: no noise is stated; neighbouring readings scatter by %.3g %s, which was used",
        channel_traits(channel).name, *level * channel_traits(channel).per_SI,
        channel_traits(channel).unit);
    warnings.emplace_back(text);
  }
  return noise;
}

}  // namespace

RecordedData read_data(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts,
                       const DiagnoseOptions& options) {
  RecordedData data;
  for (auto& stretches : observe_all(recordings, nominal, options, data.warnings)) {
    if (holdouts.empty()) {
      hold_out(std::move(stretches), options.holdout_fraction, data);
    } else {
      append_to(data.train, std::move(stretches));
    }
  }
  for (auto& stretches : observe_all(holdouts, nominal, options, data.warnings)) {
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
