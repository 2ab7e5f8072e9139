#include "tools/tasks/trace.h"

#include "core/files.h"
#include "tools/runs/arriving_rays.h"
#include "tools/runs/published.h"

namespace photorque {
namespace {

std::vector<const FluxMapReceiver*> flux_maps(const Experiment& experiment) {
  std::vector<const FluxMapReceiver*> maps;
  for (const NamedReceiver& named : experiment.receivers) {
    if (named.flux_map) maps.push_back(named.flux_map.get());
  }
  return maps;
}

// Told before the trace, not after it.
void check_ray_files(const Experiment& experiment) {
  if (!experiment.file.effort.arriving_rays) return;
  const Settings trace = experiment.file.settings.table("trace");
  if (flux_maps(experiment).empty()) {
    throw trace.error("arriving_rays", "no receiver of kind \"flux_map\"",
                      "one, on which the rays arrive");
  }
  constexpr size_t max_beams = 4096;  // of at least 2048 rays each, which are kept in memory
  if (experiment.beams.size() > max_beams) {
    throw trace.error("arriving_rays", std::to_string(experiment.beams.size()) + " lamps",
                      "at most " + std::to_string(max_beams));
  }
}

// Where the experiment asks for them: the rays that arrive on each flux map.
std::vector<RunFile> ray_files(const OpticalRun& run, int threads) {
  const Experiment& experiment = run.experiment();
  const std::optional<uint64_t>& rays = experiment.file.effort.arriving_rays;
  if (!rays) return {};
  const std::vector<const FluxMapReceiver*> maps = flux_maps(experiment);
  TraceOptions options = experiment.file.trace;
  options.rays = *rays;
  options.replicates = 8;  // whose spread nobody looks at
  options.threads = threads;
  std::vector<RaySet> sets =
      arriving_rays(run.scene(), experiment.lab_from_body, experiment.beams, maps, options);
  std::vector<RunFile> files;
  for (size_t i = 0; i < sets.size(); ++i) {
    if (sets[i].rays.empty()) continue;  // no ray meets it
    sets[i].name += "; " + run.provenance().one_line();
    files.push_back({"rays_" + maps[i]->name() + ".tm25ray",
                     [bytes = write_tm25(sets[i])](const std::filesystem::path& path) {
                       write_file_whole(path, bytes);
                     }});
  }
  return files;
}

}  // namespace

TraceRun trace_experiment(const RunOptions& options, const Console& console, bool with_files) {
  const auto run = std::make_shared<const OpticalRun>(options, console);
  const Experiment& experiment = run->experiment();
  check_ray_files(experiment);
  const auto published = read_published(experiment.file.others("published"));
  OpticalResult light = run->run(experiment.lab_from_body, console.progress("tracing"));
  console.done();
  RunResult result;
  if (with_files) result.files = ray_files(*run, options.threads);
  print_trace(console, *run, light);
  result.product = run->product(light);
  append(result.product,
         compare_published(published, experiment.file.attitude.tilt_rad, result.product, console));
  result.provenance = run->provenance(light);
  result.cost = {light.wall_s, light.rays};
  return {run, std::move(light), std::move(result)};
}

}  // namespace photorque
