// photorque estimate: attitude and rate by Kalman filter and smoother.
#include "tools/verbs/attitude/estimate.h"

#include <algorithm>
#include <sstream>

#include "attitude/estimation/segments.h"
#include "attitude/filtering/report.h"
#include "attitude/propagation/run.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "tools/runs/attitude_run.h"
#include "tools/runs/optical_run.h"
#include "tools/verbs/verb.h"

namespace photorque {
namespace {

// Appends a result. From the second recording on, names of tables and plots get its number.
void append_numbered(Product& into, Product one, size_t number, size_t count) {
  if (count > 1) {
    const std::string end = "_" + std::to_string(number + 1);
    for (Table& table : one.tables) table.name += end;
    for (Plot& plot : one.plots) plot.name += end;
    for (Quantity& quantity : one.quantities) {
      const size_t unit = quantity.name.rfind("_arcsec");
      quantity.name.insert(unit, end);
    }
  }
  append(into, std::move(one));
}

RunFile file_of(const std::string& name, const std::vector<AttitudeEstimate>& estimates,
                const Recording& source, const std::string& stamp, const std::string& remark) {
  const Recording recording = recording_of(estimates, source);
  return {name,
          [recording, stamp](const std::filesystem::path& path) {
            write_recording(path, recording, {stamp});
          },
          remark};
}

// Notes of the reader, one per line, without the first line (the number of rows, which is printed
// elsewhere).
std::vector<std::string> notes_of(const RecordingReport& report) {
  std::vector<std::string> lines;
  std::istringstream text(report.text());
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) lines.push_back(line);
  return lines;
}

struct Source {
  std::string name;
  Recording recording;
  TruthTrack truth;
};

std::vector<Source> read_sources(AttitudeExperiment& experiment,
                                 const std::vector<std::filesystem::path>& recordings,
                                 const std::optional<std::filesystem::path>& truth) {
  RecordingOptions options;
  const Settings& root = experiment.settings();
  const Settings columns = own_table(root, "recording", false);
  options = read_recording_options(columns);
  std::vector<Source> sources;
  for (const std::filesystem::path& path : recordings) {
    experiment.add_input(path);
    sources.push_back({path.filename().string(), read_recording(path, options), {}});
    refuse_jump_of_clock(sources.back().recording, path.string());
  }
  if (!sources.empty()) {
    std::vector<const Recording*> all;
    for (const Source& source : sources) all.push_back(&source.recording);
    refuse_absent_columns(columns, all);
  }
  columns.finish();
  if (truth) {
    if (sources.size() != 1) {
      throw InputError({}, "--truth", std::to_string(sources.size()) + " recordings",
                       "one recording that it belongs to");
    }
    experiment.add_input(*truth);
    sources[0].truth = truth_from(read_recording(*truth), sources[0].recording);
    const TruthTrack& known = sources[0].truth;
    const size_t settled = settled_row(known.size());
    const auto is_known = [](const auto& at_row) { return at_row.has_value(); };
    if (std::none_of(known.begin() + static_cast<std::ptrdiff_t>(settled), known.end(), is_known)) {
      throw InputError(
          {truth->string(), 0}, "t_s",
          printed("no time of the recording from %.6g s on", sources[0].recording.time_s[settled]),
          "the truth at the times of the recording; rows before that time, while the filter "
          "converges, are not used");
    }
  }
  return sources;
}

}  // namespace

EstimateRun run_estimate(const RunOptions& options, const Console& console,
                         const std::vector<std::filesystem::path>& recordings,
                         const std::optional<std::filesystem::path>& truth) {
  const WallTime wall;
  AttitudeExperiment experiment(options);
  EstimateRun run;
  run.study = read_estimate(experiment.settings());
  run.study.threads = options.threads;
  NominalModel& nominal = run.study.nominal;
  const auto inputs = look_through_scene(experiment.file(), nominal.sensors);
  std::vector<Source> sources = read_sources(experiment, recordings, truth);
  PropagationRun propagation;
  uint64_t seed = 0;
  if (sources.empty()) {
    require_noise(nominal.sensors);
    propagation = read_propagation(experiment.settings());
    propagation.sensors = nominal.sensors;
    if (options.seed) propagation.seed = *options.seed;
    seed = propagation.seed;
    SimulatedRun simulated = simulate_run(propagation, seed);
    sources.push_back({"simulated", std::move(simulated.recording), std::move(simulated.truth)});
  }
  run.result.provenance = experiment.provenance(seed);
  auto& files = run.result.provenance.inputs;
  files.insert(files.end(), inputs.begin(), inputs.end());
  const std::string stamp = run.result.provenance.one_line();
  const MotionModel probe(nominal.model, nominal.sensors, run.study.filter, {});
  for (size_t i = 0; i < sources.size(); ++i) {
    const Source& source = sources[i];
    EstimateStudy study = run.study;
    RecordingNoise noise =
        with_noise_of(nominal.sensors, source.recording, source.name, nominal.model.platform);
    study.nominal.sensors = noise.sensors;
    EstimateRun::Estimated one{
        source.name,
        readings_of(source.recording, source.name, nominal.model.platform, probe.camera_delay_s()),
        {},
        notes_of(source.recording.report)};
    one.notes.insert(one.notes.end(), noise.found.begin(), noise.found.end());
    one.result = estimate_by_all_methods(study, one.readings, source.truth,
                                         console.progress("estimating " + source.name));
    console.done();
    const std::string end = sources.size() > 1 ? "_" + std::to_string(i + 1) : "";
    const Estimation& chosen = one.result.methods[one.result.chosen].estimation;
    run.result.files.push_back(file_of("smoothed" + end + ".csv", chosen.smoothed, source.recording,
                                       stamp, "a recording, smoothed"));
    run.result.files.push_back(file_of("filtered" + end + ".csv", chosen.filtered, source.recording,
                                       stamp, "a recording, filtered"));
    append_numbered(run.result.product, one.result.product, i, sources.size());
    run.estimated.push_back(std::move(one));
  }
  if (recordings.empty() && run.study.runs > 0) {
    const EstimateResult& first = run.estimated.front().result;
    run.consistency = consistency_of(run.study, propagation, first.methods[first.chosen].settings,
                                     console.progress("simulated runs"));
    console.done();
    append_numbered(run.result.product, run.consistency->product, 0, 1);
  }
  run.result.cost = {wall.elapsed_s(), {}};
  return run;
}

}  // namespace photorque

namespace photorque::verbs::estimate {
namespace {

struct Options : CommandOptions {
  std::vector<std::filesystem::path> recordings;
  std::optional<std::filesystem::path> truth;
};

std::string band_text(const Band& band) {
  return "95 % band " + show(band.low) + " to " + show(band.high);
}

void print_innovations(const Console& console, const std::string& name, const InnovationSum& sum) {
  if (!(sum.numbers > 0.0)) return;
  console.line("  NIS of " + padded(name, 9) + show(sum.per_number()) + " per number, of " +
               show(sum.numbers) + "; " + band_text(innovation_band(sum)));
}

void print_method(const Console& console, const EstimateRun::Estimated& one) {
  const Readings& readings = one.readings;
  const EstimateResult& result = one.result;
  console.heading(one.name + ": " + std::to_string(readings.rows) + " rows, " +
                  show(readings.last_s - readings.first_s) + " s" +
                  (readings.sees_attitude()
                       ? ", longest gap between attitudes " + show(readings.longest_gap_s) + " s"
                       : ""));
  if (!readings.unused.empty()) {
    std::string names;
    for (const std::string& name : readings.unused) names += " " + name;
    console.line("  columns not used:" + names);
  }
  for (const std::string& note : one.notes) console.line("  " + note);
  print_table(console, result.product.tables[0],
              {{"method", "way"},
               {"", "estimate"},
               {"rms error [\"]", "rms_error_arcsec"},
               {"predicted [\"]", "predicted_arcsec"},
               {"rms rate error [rad/s]", "rms_rate_error_rad_s"},
               {"NEES", "nees_per_number"},
               {"rows in 95 %", "rows_in_95_band"},
               {"NIS attitude", "nis_attitude"},
               {"NIS gyro", "nis_gyro"},
               {"rate walk", "rate_walk"}});
  const Ingredients& chosen = result.methods[result.chosen];
  console.heading("Written: " + chosen.name);
  print_innovations(console, "attitude", chosen.estimation.attitude);
  print_innovations(console, "gyro", chosen.estimation.gyro);
  print_innovations(console, "yaw", chosen.estimation.yaw);
  if (!result.unseen.empty()) console.heading("Undetermined by these readings");
  for (const std::string& line : result.unseen) console.line("  " + line);
  if (!chosen.estimation.parameter_names.empty()) {
    constexpr size_t most_rows = 8;
    console.line();
    print_table(console, result.product.tables[1],
                {{"parameter", "parameter"},
                 {"seen", "seen"},
                 {"before", "before"},
                 {"sigma", "sigma_before"},
                 {"after", "after"},
                 {"sigma", "sigma_after"}},
                most_rows);
  }
}

void print_consistency(const Console& console, const ConsistencyResult& result) {
  const RunEnsemble& ensemble = result.ensemble;
  console.heading(std::to_string(ensemble.runs) + " simulated runs");
  console.line("  mean NEES: " + band_text(ensemble.band) + "; within it " +
               show_percent(result.part_filtered) + " of the rows filtered, " +
               show_percent(result.part_smoothed) + " smoothed (95 % expected)");
  print_innovations(console, "attitude", ensemble.attitude);
  print_innovations(console, "gyro", ensemble.gyro);
  console.line("  rms error of the smoother over that of the filter: at most " +
               show(result.worst_gain) + " at any row");
}

void add_options(Command& command, Options& options) {
  command.add_experiment(options);
  command.add_recordings(options.recordings);
  command.add("--truth", options.truth,
              "True motion of the recording, for comparison (CSV with q_w …, such as "
              "time_history.csv of propagate)");
}

RunResult run(const Options& options, const Console& console) {
  const EstimateRun run = run_estimate(options, console, options.recordings, options.truth);
  for (const EstimateRun::Estimated& one : run.estimated) print_method(console, one);
  if (run.consistency) print_consistency(console, *run.consistency);
  return run.result;
}

}  // namespace

Verb kind() {
  return {"estimate",
          "Attitude and rate by Kalman filter and smoother, from recordings or simulated runs",
          command_that_writes(add_options, run),
          {"platform", "environment", "disturbance", "sensors", "recording", "estimate"},
          "[platform]"};
}

}  // namespace photorque::verbs::estimate
