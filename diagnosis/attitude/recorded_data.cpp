#include "diagnosis/attitude/recorded_data.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "attitude/estimation/conventions.h"
#include "attitude/estimation/fit.h"
#include "attitude/estimation/segments.h"
#include "attitude/filtering/motion_model.h"
#include "attitude/observation/bias_history.h"
#include "attitude/observation/heavy_tails.h"
#include "attitude/observation/noise_levels.h"
#include "attitude/observation/noise_search.h"
#include "attitude/recordings/cleaning.h"
#include "attitude/recordings/columns.h"
#include "core/constants.h"
#include "core/text/format.h"

namespace photorque {
namespace {

// Minimum number of blocks of a segment: more than its initial conditions require.
constexpr size_t min_segment_blocks = 12;

// Warns of rows that are omitted where a file is cut into segments.
void warn_of_omitted_rows(const std::string& name, const Segments& segments,
                          std::vector<std::string>& warnings) {
  const auto note = [&](int64_t count, const char* what) {
    if (count > 0) warnings.push_back(name + ": " + std::to_string(count) + what);
  };
  note(segments.events,
       " rows with an event are left out; a new segment starts after each of them");
  note(segments.kinks,
       " rows where the rate jumps without a recorded event are left out; a new segment starts "
       "after each of them");
  note(segments.long_gaps, " long gaps: a new segment starts after each of them");
  note(segments.too_short,
       " segments with too few readings for their initial conditions are left out");
  for (const std::string& note : segments.notes) warnings.push_back(name + ": " + note);
  for (const std::string& why : segments.exclusions) {
    warnings.push_back(name + ": " + why + ", which is left out");
  }
}

// An accelerometer or magnetometer is used only if the experiment declares it: a recording contains
// neither the position of the former nor the disturbances of the latter.
bool is_declared(const Sensors& sensors, int scalar) {
  const Measures measures = channel_traits(vector_channels + scalar).measures;
  if (measures == Measures::force) return sensors.accelerometer.has_value();
  return measures != Measures::field || sensors.magnetometer.has_value();
}

void report_unused_columns(const NamedRecording& r, const NominalModel& nominal,
                           const std::set<std::string>& read_elsewhere,
                           std::vector<std::string>& warnings) {
  const Platform& platform = nominal.model.platform;
  std::vector<std::string> undeclared;
  const MotionColumns motion(r.recording, platform, r.name);
  for (int s = first_field; s < first_place; ++s) {
    if (is_declared(nominal.sensors, s) || !motion.has_scalar(static_cast<Scalar>(s))) continue;
    undeclared.emplace_back(channel_traits(vector_channels + s).column);
  }
  if (!undeclared.empty()) {
    warnings.push_back(r.name + ": " + joined_text(undeclared, ", ") +
                       " are not compared: the experiment has no [sensors.accelerometer] or "
                       "[sensors.magnetometer] for them");
  }
  std::vector<std::string> unused = motion.unused();
  std::erase_if(unused, [&](const std::string& column) { return read_elsewhere.contains(column); });
  if (unused.empty()) return;
  warnings.push_back(r.name + ": columns that are not used: " + joined_text(unused, ", "));
}

// Warns of an assumed sequence of angles if no rates are recorded that could test it.
void warn_of_assumed_sequence(const NamedRecording& r, const Platform& platform,
                              std::vector<std::string>& warnings) {
  const MotionColumns columns(r.recording, platform, r.name);
  if (!columns.has_angles() || columns.has_gyro() || !r.recording.angle_sequence.empty()) return;
  warnings.push_back(r.name + ": roll, pitch and yaw are taken in the sequence zyx, " +
                     formula_of(angle_sequences[0]) +
                     "; there are no rates to test it; [recording] angle_sequence states it");
}

// A sliding body whose commanded forces respond to its position hardly moves. Over a whole run the
// best fit is then a model without any force, even without the commanded one (closed-loop
// identification, L. Ljung, System Identification, 2nd ed. 1999, section 13.4). In short segments
// with separate initial conditions the forces are identifiable.
void split_commanded_runs(const std::string& name, const Platform& platform, size_t segments,
                          std::vector<Observation>& all, std::vector<std::string>& warnings) {
  std::vector<Observation> result;
  for (const Observation& seen : all) {
    const bool is_commanded =
        platform.slides() && std::ranges::any_of(seen.schedule.held, [](const ZeroOrderHold& held) {
          return held.commands_force();
        });
    const size_t count = is_commanded ? std::min(segments, seen.blocks() / min_segment_blocks) : 1;
    for (size_t i = 0; i < count; ++i) {
      result.push_back(count == 1
                           ? seen
                           : seen.part(i * seen.blocks() / count, (i + 1) * seen.blocks() / count));
    }
    if (count > 1) {
      warnings.push_back(
          printed("%s: commanded forces may depend on the motion: %zu "
                  "segments, each with its own initial state",
                  name.c_str(), count));
    }
  }
  all = std::move(result);
}

// The value of a channel in a block; for attitudes a component of the rotation vector.
double value_at(const Observation& seen, int channel, size_t block) {
  if (channel >= vector_channels) {
    return seen.scalar[static_cast<size_t>(channel - vector_channels)].value[block];
  }
  if (channel >= 3) return seen.gyro_rad_s[block][channel - 3];
  return turn_vector(seen.attitude[block])[channel];
}

// A counter at rest repeats the same rounding error in every reading, so its readings are not
// independent. Only a few evenly spaced ones of a long sequence of identical values are kept.
void thin_repetitions(Observation& seen) {
  constexpr size_t most = 10;
  constexpr double rounding = 1e-12;
  for (int channel = 0; channel < channel_count; ++channel) {
    std::vector<size_t> read;
    for (size_t i = 0; i < seen.blocks(); ++i) {
      if (seen.rows_of(i, channel) > 0.0) read.push_back(i);
    }
    for (size_t first = 0; first < read.size();) {
      const double value = value_at(seen, channel, read[first]);
      size_t last = first + 1;
      while (last < read.size() && std::abs(value_at(seen, channel, read[last]) - value) <=
                                       rounding * std::max(1.0, std::abs(value))) {
        ++last;
      }
      const size_t count = last - first;
      for (size_t k = 0; count > most && k < count; ++k) {
        if (k * most / count == (k + 1) * most / count) {
          seen.rows_in(read[first + k], channel) = 0.0;
        }
      }
      first = last;
    }
  }
}

// The segments of each recording.
std::vector<std::vector<Observation>> observe_all(const std::vector<NamedRecording>& recordings,
                                                  const NominalModel& nominal,
                                                  const DiagnoseOptions& options,
                                                  std::vector<std::string>& warnings) {
  const Platform& platform = nominal.model.platform;
  std::vector<std::vector<Observation>> all;
  for (const NamedRecording& r : recordings) {
    refuse_jump_of_clock(r.recording, r.name);
    Segments segments = observe_segments(r.recording, r.name, platform, options.max_blocks);
    MotionModel::refuse_rows_far_apart(segments.all.front(), nominal.model);
    warn_of_omitted_rows(r.name, segments, warnings);
    if (const int64_t rows = r.recording.report.isolated_rows; rows > 0) {
      warnings.push_back(r.name + ": rows at an end beyond a jump of the clock: " +
                         std::to_string(rows) + " left out");
    }
    if (r.recording.report.held_readings > 0) {
      warnings.push_back(r.name + ": " + held_readings_text(r.recording.report));
    }
    if (r.recording.report.has_decimal_commas) {
      warnings.push_back(r.name + ": its numbers have decimal commas, read as points");
    }
    if (r.recording.report.has_old_yaw) {
      warnings.push_back(r.name +
                         ": its column heading is read as yaw, the azimuth of body x: "
                         "name it yaw_rad, or yaw_deg");
    }
    report_unused_columns(r, nominal, options.read_elsewhere, warnings);
    warn_of_assumed_sequence(r, platform, warnings);
    if (MotionColumns(r.recording, platform, r.name).has_scalar(Scalar::tilt)) {
      warnings.push_back(
          r.name +
          ": a tilt has no direction: the mirror image of the motion has equal readings. Only the "
          "priors distinguish them, so that the signs found may be those of the mirror image");
    }
    std::string convention = segments.angles ? segments.angles->text : "";
    for (Observation& seen : segments.all) {
      for (int s = 0; s < scalar_count; ++s) {
        if (!is_declared(nominal.sensors, s)) seen.scalar[static_cast<size_t>(s)] = {};
      }
      seen.fields = field_instruments(nominal.sensors);
      if (platform.turns_about_one_axis() || platform.slides()) thin_repetitions(seen);
    }
    std::string of_rates = repair_conventions(segments.all);
    if (!platform.has_bearing())
      of_rates += repair_free_rates(segments.all, platform.inertia_kg_m2);
    if (convention.empty()) convention = of_rates;
    if (!convention.empty()) warnings.push_back(r.name + ": " + convention);
    split_commanded_runs(r.name, platform, options.limits.discrepancy.segments, segments.all,
                         warnings);
    all.push_back(std::move(segments.all));
  }
  return all;
}

// The first block of the last part of a run; `fraction` counts only blocks with readings.
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

// Holds out the last quarter of a recording in one piece. Of many segments, every fourth is held
// out, so that held-out and fitted data cover equal times and conditions.
void hold_out(std::vector<Observation> segments, RecordedData& data) {
  constexpr double fraction = 0.25;
  constexpr size_t every = 4;
  for (size_t i = 0; i < segments.size(); ++i) {
    Observation& seen = segments[i];
    if (segments.size() >= every) {
      (i % every == every - 1 ? data.held : data.train).push_back(std::move(seen));
      continue;
    }
    const size_t cut = cut_at(seen, fraction);
    data.held.push_back(seen.part(cut, seen.blocks()));
    data.train.push_back(seen.part(0, cut));
  }
}

// Noise levels from the experiment. If it states none and no second instrument measures the motion,
// they are estimated from the readings.
NoiseLevels noise_of(const Sensors& sensors, const std::vector<Observation>& runs,
                     std::vector<std::string>& warnings) {
  NoiseLevels noise = noise_levels(sensors);
  const bool can_be_found = runs.front().sees_attitude();
  for (int channel = 0; !can_be_found && channel < channel_count; ++channel) {
    if (states_noise(sensors, channel)) continue;
    const std::optional<double> level = reading_level(runs, channel);
    if (!level) continue;
    noise.set(channel, {*level, 0.0, 0.0});
    const ChannelTraits& traits = channel_traits(channel);
    warnings.push_back(
        printed("%s: no noise is stated; neighbouring readings scatter by %.3g %s, which was used",
                traits.name, *level * traits.per_SI, traits.unit));
  }
  return noise;
}

InstrumentFinding level_finding(int k, const FoundNoise& found, double stated) {
  const double unit = k < 3 ? arcsecond_rad : 1.0;
  const double value = found.noise.level / unit;
  return {
      channel_traits(k).name, "noise_level", value, found.level_sigma * value,
      printed("the noise of %s differs from the stated one: %.3g %s were estimated from the "
              "recording and used; %.3g is stated",
              channel_traits(k).name_in_text, value, k < 3 ? "arcsec" : "rad/s", stated / unit)};
}

InstrumentFinding colour_finding(int k, const FoundNoise& found) {
  const bool all = !(found.noise.coloured < 1.0);
  return {
      channel_traits(k).name, "noise_correlation_time_s", found.noise.time_s, found.time_sigma_s,
      printed(
          "the noise of %s is correlated over %.3g s%s: neighbouring readings count for "
          "less",
          channel_traits(k).name_in_text, found.noise.time_s,
          all ? "" : printed(" (%.0f %% of its variance)", 100.0 * found.noise.coloured).c_str())};
}

InstrumentFinding tail_finding(int k, const HeavyTail& tail) {
  const double unit = k < 3 ? arcsecond_rad : 1.0;
  return {
      channel_traits(k).name, "noise_degrees_of_freedom", tail.degrees, tail.degrees_sigma,
      printed("the noise of %s has heavy tails (Student's t with %.2g degrees of freedom, scale "
              "%.3g %s): readings far from their neighbours count for less",
              channel_traits(k).name_in_text, tail.degrees, tail.scale / unit,
              k < 3 ? "arcsec" : "rad/s")};
}

// Uses the estimated noise for the runs and reports it. Returns whether it changed.
bool use_noise(const NoiseFindings& findings, RecordedData& data) {
  bool changed = false;
  const NoiseLevels stated = data.train.front().noise;
  for (int k = 0; k < 6; ++k) {
    const FoundNoise& found = findings.channel[static_cast<size_t>(k)];
    if (found.level_found) data.instruments.push_back(level_finding(k, found, stated.of(k).level));
    if (found.colour_found) data.instruments.push_back(colour_finding(k, found));
    if (!found.level_found && !found.colour_found) continue;
    changed = true;
    set_noise(k, found.noise, data);
  }
  return changed;
}

// Limits the weight of readings that are not normally distributed, in fitted and held-out data:
// bursts are dropped and heavy tails get pseudo-values. `near` is a fit that is near the readings.
// Returns whether anything changed.
bool robustify_noise(const Fit& near, const Thresholds& limits, RecordedData& data) {
  const int64_t in_bursts = drop_bursts(residuals_of(near, data.train), limits.noise, data.train);
  const std::vector<Prediction> residuals = residuals_of(near, data.train);
  const HeavyTails tails = heavy_tails(residuals, data.train, limits.noise);
  robustify(tails, residuals, data.train);
  const std::vector<Prediction> robustified = residuals_of(near, data.train);
  bool changed = in_bursts > 0;
  for (int k = 0; k < 6; ++k) {
    const std::optional<HeavyTail>& tail = tails[static_cast<size_t>(k)];
    if (!tail) continue;
    changed = true;
    data.instruments.push_back(tail_finding(k, *tail));
    set_noise(k, {deviation_level(robustified, data.train, k), 0.0, 0.0}, data);
  }
  int64_t held_in_bursts = 0;
  const Fit held = propagate_model(near, data.held, limits);
  if (std::isfinite(held.chi2)) {
    held_in_bursts = drop_bursts(residuals_of(held, data.held), limits.noise, data.held);
    robustify(tails, residuals_of(held, data.held), data.held);
  }
  if (const long long all = in_bursts + held_in_bursts; all > 0) {
    data.outliers += all;
    data.warnings.push_back(printed("%lld readings in bursts of large errors are left out", all));
  }
  return changed;
}

// Estimates the noise from residuals of a fit near the readings and uses it. Returns whether
// anything changed.
bool find_and_use_noise(const Fit& near, const Thresholds& limits, RecordedData& data) {
  NoiseFindings findings = find_noise(data.train, residuals_of(near, data.train), limits.noise);
  data.noise_is_open = findings.is_open;
  if (findings.is_open) return false;
  const bool robustified = robustify_noise(near, limits, data);
  if (robustified) findings = find_noise(data.train, residuals_of(near, data.train), limits.noise);
  const NoiseLevels before = data.train.front().noise;
  const bool changed = use_noise(findings, data);
  // The pseudo-values of heavy tails are computed with this noise.
  if (changed && !robustified) data.noise_before = before;
  return changed || robustified;
}

// Reports the largest deviation of the bias from its mean for each axis.
void report_bias_drift(const BiasHistory& history, std::vector<InstrumentFinding>& findings) {
  const std::string name = std::filesystem::path(history.recording).filename().string();
  for (int axis = 0; axis < 3; ++axis) {
    size_t at = 0;
    for (size_t k = 1; k < history.time_s.size(); ++k) {
      if (std::abs(history.bias_rad_s[k][axis]) > std::abs(history.bias_rad_s[at][axis])) at = k;
    }
    const double off = history.bias_rad_s[at][axis], sigma = history.sigma_rad_s[at][axis];
    findings.push_back(
        {channel_traits(3 + axis).name, "bias_drift_rad_s", off, sigma,
         printed("the bias of the gyro about body %c drifts: in %s it is (%.3g ± %.1g) rad/s off "
                 "its mean at %.0f s; the drift is removed",
                 'x' + axis, name.c_str(), off, sigma, history.time_s[at])});
  }
}

}  // namespace

void set_noise(const NoiseLevels& noise, RecordedData& data) {
  for_each_run(data, [&](Observation& seen) { seen.noise = noise; });
}

void set_noise(int channel, const ChannelNoise& noise, RecordedData& data) {
  for_each_run(data, [&](Observation& seen) { seen.noise.set(channel, noise); });
}

RecordedData read_data(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts,
                       const DiagnoseOptions& options) {
  RecordedData data;
  for (auto& segments : observe_all(recordings, nominal, options, data.warnings)) {
    if (holdouts.empty()) {
      hold_out(std::move(segments), data);
    } else {
      std::ranges::move(segments, std::back_inserter(data.train));
    }
  }
  for (auto& segments : observe_all(holdouts, nominal, options, data.warnings)) {
    std::ranges::move(segments, std::back_inserter(data.held));
  }
  set_noise(noise_of(nominal.sensors, data.train, data.warnings), data);
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
      q.rejected["isolated_row"] += report.isolated_rows;
      q.rejected["held_reading"] += report.held_readings;
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

Fit settle(const NominalModel& nominal, const Thresholds& limits, RecordedData& data) {
  subtract_bias_drift(data);
  Fit fitted = fit_nominal(nominal, data.train, limits);
  // A model that cannot be propagated along the recording has no residuals.
  if (!std::isfinite(fitted.chi2)) return fitted;
  const std::vector<Prediction> residuals = residuals_of(fitted, data.train);
  data.outliers = drop_outliers(residuals, limits.noise, data.train);
  bool changed = data.outliers > 0;
  // Without attitude readings, noise and motion are not separable.
  if (!nominal.sensors.noise_is_stated && data.train.front().sees_attitude()) {
    changed = find_and_use_noise(fitted, limits, data) || changed;
  }
  if (changed) fitted = fit(fitted.best, data.train);
  const Fit held = propagate_model(fitted, data.held, limits);
  if (!std::isfinite(held.chi2)) return fitted;
  data.outliers += drop_outliers(residuals_of(held, data.held), limits.noise, data.held);
  return fitted;
}

bool estimate_noise_again(const Fit& explained, const Thresholds& limits, RecordedData& data) {
  if (!(explained.chi2_per_sample() < limits.diverged_chi2_per_sample)) return false;
  if (data.noise_is_open) {
    const bool changed = find_and_use_noise(explained, limits, data);
    data.noise_is_open = false;
    return changed;
  }
  if (!data.noise_before) return false;
  RecordedData again = data;
  set_noise(*data.noise_before, again);
  again.noise_before.reset();
  std::erase_if(again.instruments, [](const InstrumentFinding& finding) {
    return finding.what == "noise_level" || finding.what == "noise_correlation_time_s";
  });
  use_noise(find_noise(again.train, residuals_of(explained, again.train), limits.noise), again);
  const NoiseLevels &now = again.train.front().noise, &before = data.train.front().noise;
  bool is_whiter = false;
  for (int k = 0; k < 6; ++k) {
    is_whiter = is_whiter || (before.of(k).coloured > 0.0 && !(now.of(k).coloured > 0.0));
  }
  if (!is_whiter && !is_quieter(now, before)) return false;
  data = std::move(again);
  return true;
}

void subtract_bias_drift(RecordedData& data) {
  std::vector<const Observation*> pieces;
  for_each_run(data, [&](const Observation& seen) { pieces.push_back(&seen); });
  for (const BiasHistory& history : bias_histories(pieces)) {
    for_each_run(data, [&](Observation& seen) {
      if (seen.name != history.recording) return;
      for (size_t i = 0; i < seen.blocks(); ++i) {
        seen.gyro_rad_s[i] -= history.at(seen.time_s[i]);
      }
    });
    report_bias_drift(history, data.instruments);
  }
}

}  // namespace photorque
