#include "diagnosis/attitude/diagnose.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "diagnosis/attitude/account.h"
#include "diagnosis/attitude/conventions.h"
#include "diagnosis/attitude/empirical_torque.h"
#include "diagnosis/attitude/holdout.h"
#include "diagnosis/attitude/locate.h"
#include "diagnosis/attitude/manoeuvre.h"
#include "diagnosis/attitude/nominal_model.h"
#include "diagnosis/attitude/search.h"
#include "diagnosis/attitude/weigh.h"
#include "diagnosis/attitude/whiteness.h"

namespace photorque {
namespace {

struct Data {
  std::vector<Observation> train, held;
  int64_t outliers = 0;
  bool noise_corrected = false;
  std::vector<std::string> warnings;
};

NoiseLevels noise_of(const Sensors& sensors) {
  NoiseLevels noise;
  if (sensors.camera && sensors.camera->noise_rad.minCoeff() > 0.0) {
    noise.camera_rad = sensors.camera->noise_rad;
  }
  if (sensors.gyro && sensors.gyro->noise_rad_s > 0.0) {
    noise.gyro_rad_s = Vec3::Constant(sensors.gyro->noise_rad_s);
  }
  return noise;
}

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

Data read_data(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
               const std::vector<NamedRecording>& holdouts, const DiagnoseOptions& options) {
  const NoiseLevels noise = noise_of(nominal.sensors);
  Data data;
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

// The nominal model fitted; readings that stand out are dropped and wrong noise levels repaired on
// the way.
Fit settle(const NominalModel& nominal, const Thresholds& limits, Data& data) {
  Fit fitted = fit_nominal(nominal, data.train, limits);
  if (!std::isfinite(fitted.chi2)) {
    throw NumericalError("the believed model cannot be propagated along the recording");
  }
  const std::vector<Prediction> residuals = residuals_of(fitted, data.train);
  data.outliers = drop_outliers(residuals, data.train, limits.noise);
  const Whiteness found = whiteness(residuals, limits.noise);
  data.noise_corrected = correct_noise(found, data.train, limits.noise);
  correct_noise(found, data.held, limits.noise);
  if (data.outliers > 0 || data.noise_corrected) fitted = fit(fitted.best, data.train);
  const Fit held = propagate_model(fitted, data.held, limits);
  data.outliers += drop_outliers(residuals_of(held, data.held), data.held, limits.noise);
  return fitted;
}

DataQuality quality_of(const std::vector<NamedRecording>& recordings,
                       const std::vector<NamedRecording>& holdouts, const Data& data) {
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

Replay replay_of(const Fit& fit, const Observation& seen) {
  Replay replay;
  replay.recording = seen.name;
  for (const ZeroOrderHold& held : seen.schedule.held) {
    replay.has_commands = replay.has_commands || held != ZeroOrderHold{};
  }
  replay.duration_s = seen.duration_s();
  replay.output_rate_Hz = static_cast<double>(seen.blocks() - 1) / seen.duration_s();
  const PlatformState& initial = fit.best.runs.front().initial;
  const Quat& q = initial.lab_from_body;
  replay.initial_attitude = {q.w(), q.x(), q.y(), q.z()};
  replay.initial_rate_rad_s = initial.rate_body_rad_s;
  return replay;
}

void tell(const DiagnoseOptions& options, const std::string& what) {
  if (options.progress) options.progress(what);
}

}  // namespace

Diagnosis diagnose(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
                   const std::vector<NamedRecording>& holdouts, const DiagnoseOptions& options) {
  if (recordings.empty()) throw InputError({}, "--recording", "none", "at least one recording");
  Data data = read_data(nominal, recordings, holdouts, options);
  tell(options, "fitting what is believed");
  const Fit nominal_fit = settle(nominal, options.limits, data);
  const Candidates all = all_candidates(nominal, data.train, options.limits);
  tell(options, "fitting every effect of the catalogue");
  std::vector<Trial> trials =
      search(nominal_fit, all, data.train, {options.threads, options.max_effects});
  // Before the runs held out count: in one that diverges there all explanations differ by
  // chance.
  const std::vector<Where::Dependence> depends_on = dependences(trials, all);
  tell(options, "comparing with what was held back");
  weigh_with_holdout(trials, all, {data.train, data.held}, options.threads);
  const Decision decision = decide(trials, all, data.train);
  const Trial& chosen = trials[decision.chosen];

  Diagnosis d;
  d.verdict = decision.verdict;
  d.confidence = decision.confidence;
  d.where = locate(residuals_of(nominal_fit, data.train), data.train, all.limits.location);
  if (d.verdict == Verdict::missing_physics) d.where.depends_on = depends_on;
  if (d.verdict == Verdict::unexplained) {
    d.where.depends_on = of_unknown_law(depends_on, chosen, all);
  }
  if (d.verdict == Verdict::missing_physics) d.effects = found_effects(decision, trials, all);
  if (d.verdict == Verdict::unexplained) d.empirical = empirical_torques(chosen, all, data.train);
  d.chi2_per_sample_before = nominal_fit.chi2_per_sample();
  d.chi2_per_sample_after = chosen.fit.chi2_per_sample();
  d.samples = nominal_fit.samples;
  const Fit held_before = propagate_model(nominal_fit, data.held, all.limits),
            held_after = propagate_model(chosen.fit, data.held, all.limits);
  d.holdout = compare_holdout(held_before, held_after, data.held);
  d.alternatives = alternatives(decision, trials, all);
  d.manoeuvres = manoeuvres(d.effects, decision, trials, all, data.train, options.threads);
  d.priors_refined = refined_priors(chosen);
  d.warnings = data.warnings;
  if (data.noise_corrected) {
    d.warnings.push_back(
        "the noise of the readings is not what the experiment states: the level "
        "found in the recording was used");
  }
  if (decision.undecided) {
    d.warnings.push_back(
        "the recordings and what was held back show together what neither shows alone, but not "
        "which effect it is: see the alternatives");
  }
  d.data = quality_of(recordings, holdouts, data);
  for (size_t run = 0; run < data.train.size(); ++run) {
    d.series.push_back(series_of(nominal_fit, chosen.fit, data.train[run], run));
  }
  for (size_t run = 0; run < data.held.size(); ++run) {
    d.series.push_back(series_of(held_before, held_after, data.held[run], run));
    d.series.back().held_out_s = {{data.held[run].time_s.front(), data.held[run].time_s.back()}};
  }
  d.replay = replay_of(chosen.fit, data.train.front());
  d.sentence = sentence_of(d);
  return d;
}

}  // namespace photorque
