// photorque trace: irradiance on every receiver, power ledger, radiation wrench.
#include "core/files.h"
#include "tools/arriving_rays.h"
#include "tools/optical_run.h"
#include "tools/published.h"

namespace photorque {
namespace {

struct RayFile {
  std::string name, bytes;
};

// Where the experiment asks for them: the rays that arrive on each flux map.
std::vector<RayFile> ray_files(const OpticalRun& run, const CommandLine& line) {
  const Experiment& experiment = run.experiment();
  const std::optional<uint64_t>& rays = experiment.file.effort.arriving_rays;
  if (!rays || line.summary_only) return {};
  run.flux_map_index("");  // at least one
  std::vector<const FluxMapReceiver*> maps;
  for (const NamedReceiver& named : experiment.receivers) {
    const auto* map = dynamic_cast<const FluxMapReceiver*>(named.receiver.get());
    if (map != nullptr) maps.push_back(map);
  }
  TraceOptions options = experiment.file.trace;
  options.rays = *rays;
  options.replicates = 8;  // whose spread nobody looks at
  options.threads = line.threads;
  const std::vector<RaySet> sets =
      arriving_rays(run.scene(), experiment.lab_from_body, experiment.beams, maps, options);
  std::vector<RayFile> files;
  for (size_t i = 0; i < sets.size(); ++i) {
    files.push_back({"rays_" + maps[i]->name() + ".tm25ray", write_tm25(sets[i])});
  }
  return files;
}

void run_trace(const CommandLine& line) {
  Console console(line);
  const OpticalRun run(line, console);
  const auto published = read_published(run.experiment().file.others("published"));
  const OpticalResult result = run.run(run.experiment().lab_from_body, console.progress("tracing"));
  console.done();
  const std::vector<RayFile> files = ray_files(run, line);
  print_trace(console, run, result);
  Product product = run.product(result);
  Table table =
      compare_published(published, run.experiment().file.attitude.tilt_rad, product, console);
  if (!table.columns.empty()) product.tables.push_back(std::move(table));
  write_results(line, console, product, run.provenance(), result.rays, result.wall_s);
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
