#include "tools/tracking/estimate.h"

#include <algorithm>

#include "attitude/propagation/run.h"
#include "attitude/stretches/segments.h"
#include "core/errors.h"
#include "tools/runs/camera_sight.h"

namespace photorque {
namespace {

// Tables and plots of the second recording and later ones carry its number.
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
  for (auto& item : one.quantities) into.quantities.push_back(std::move(item));
  for (auto& item : one.tables) into.tables.push_back(std::move(item));
  for (auto& item : one.plots) into.plots.push_back(std::move(item));
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
  columns.finish();
  std::vector<Source> sources;
  for (const std::filesystem::path& path : recordings) {
    experiment.add_input(path);
    sources.push_back({path.filename().string(), read_recording(path, options), {}});
    refuse_jump_of_clock(sources.back().recording, path.string());
  }
  if (truth) {
    if (sources.size() != 1) {
      throw InputError({}, "--truth", std::to_string(sources.size()) + " recordings",
                       "one recording that it belongs to");
    }
    experiment.add_input(*truth);
    sources[0].truth = truth_from(read_recording(*truth), sources[0].recording);
    const auto known = std::ranges::count_if(sources[0].truth,
                                             [](const auto& at_row) { return at_row.has_value(); });
    if (known == 0) {
      throw InputError({truth->string(), 0}, "t_s", "no time of the recording",
                       "the truth at the recording's times");
    }
  }
  return sources;
}

}  // namespace

EstimateRun estimate_of_experiment(const RunOptions& options, const Console& console,
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
        std::move(noise.found)};
    one.result = estimate_ways(study, one.readings, source.truth,
                               console.progress("estimating " + source.name));
    console.done();
    const std::string end = sources.size() > 1 ? "_" + std::to_string(i + 1) : "";
    const Estimation& chosen = one.result.ways[one.result.chosen].estimation;
    run.result.files.push_back(file_of("smoothed" + end + ".csv", chosen.smoothed, source.recording,
                                       stamp, "a recording, smoothed"));
    run.result.files.push_back(file_of("filtered" + end + ".csv", chosen.filtered, source.recording,
                                       stamp, "a recording, filtered"));
    append_numbered(run.result.product, one.result.product, i, sources.size());
    run.estimated.push_back(std::move(one));
  }
  if (recordings.empty() && run.study.runs > 0) {
    const EstimateResult& first = run.estimated.front().result;
    run.consistency = consistency_of(run.study, propagation, first.ways[first.chosen].settings,
                                     console.progress("simulated runs"));
    console.done();
    append_numbered(run.result.product, run.consistency->product, 0, 1);
  }
  run.result.cost = {wall.elapsed_s(), {}};
  return run;
}

}  // namespace photorque
