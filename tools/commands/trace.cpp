// photorque trace: irradiance on every receiver, power balance, radiation wrench.
#include "core/files.h"
#include "tools/runs/arriving_rays.h"
#include "tools/runs/optical_run.h"
#include "tools/runs/published.h"

namespace photorque {
namespace {

struct RayFile {
  std::string name, bytes;
};

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
std::vector<RayFile> ray_files(const OpticalRun& run, const CommandLine& line) {
  const Experiment& experiment = run.experiment();
  const std::optional<uint64_t>& rays = experiment.file.effort.arriving_rays;
  if (!rays || line.summary_only) return {};
  const std::vector<const FluxMapReceiver*> maps = flux_maps(experiment);
  TraceOptions options = experiment.file.trace;
  options.rays = *rays;
  options.replicates = 8;  // whose spread nobody looks at
  options.threads = line.threads;
  std::vector<RaySet> sets =
      arriving_rays(run.scene(), experiment.lab_from_body, experiment.beams, maps, options);
  std::vector<RayFile> files;
  for (size_t i = 0; i < sets.size(); ++i) {
    if (sets[i].rays.empty()) continue;  // no ray meets it
    sets[i].name += "; " + run.provenance().one_line();
    files.push_back({"rays_" + maps[i]->name() + ".tm25ray", write_tm25(sets[i])});
  }
  return files;
}

void run_trace(const CommandLine& line) {
  Console console(line);
  const OpticalRun run(line, console);
  check_ray_files(run.experiment());
  const auto published = read_published(run.experiment().file.others("published"));
  const OpticalResult result = run.run(run.experiment().lab_from_body, console.progress("tracing"));
  console.done();
  const std::vector<RayFile> files = ray_files(run, line);
  print_trace(console, run, result);
  Product product = run.product(result);
  Table table =
      compare_published(published, run.experiment().file.attitude.tilt_rad, product, console);
  if (!table.columns.empty()) product.tables.push_back(std::move(table));
  write_results(line, console, product, run.provenance(result), result.rays, result.wall_s);
  for (const RayFile& file : files) {
    write_file_whole(line.out_folder() / file.name, file.bytes);
    console.line("  " + file.name);
  }
}

}  // namespace

Verb trace_verb() {
  return {"trace", "Irradiance on every receiver, where the power went, radiation force and torque",
          run_trace, true};
}

}  // namespace photorque
