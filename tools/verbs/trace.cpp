// photorque trace: irradiance on every receiver, power balance, radiation wrench.
#include "tools/verbs/trace.h"

#include <memory>
#include <span>

#include "core/files.h"
#include "raytrace/tracing/tracer.h"
#include "receivers/flux_map.h"
#include "sources/photometry/ray_set.h"
#include "tools/pages/pages.h"
#include "tools/runs/published.h"
#include "tools/verbs/verb.h"

namespace photorque {
namespace {

// Wavelength of a source with a line spectrum; 0 for other spectra.
double wavelength_m(const Beam& beam) {
  return beam.spectrum.shape == Spectrum::Shape::gaussian ? beam.spectrum.centre_m : 0.0;
}

void keep(const Hits& hits, const BinnedHits& binned, double wavelength_m, double fraction,
          std::vector<RaySet::Ray>& rays) {
  for (size_t r = 0; r < static_cast<size_t>(binned.runs); ++r) {
    for (size_t i = binned.run[r].begin; i < binned.run[r].end; ++i) {
      RaySet::Ray ray;
      for (size_t k = 0; k < 3; ++k) {
        ray.origin_m[static_cast<int>(k)] = hits.position_m[k][i];
        ray.direction[static_cast<int>(k)] = hits.direction[k][i];
      }
      for (size_t b = 0; b < static_cast<size_t>(hits.bands); ++b) {
        ray.flux += fraction * hits.incident_W[b][i];
      }
      ray.wavelength_m = wavelength_m;
      if (ray.flux > 0.0) rays.push_back(ray);
    }
  }
}

// Traces `options.rays` rays and stores those that meet each of the surfaces, in the body frame:
// position, direction, power, and wavelength if the source is a line. A ray that returns after
// bounces is stored for every arrival. The fluxes sum to the power on the surface. The number of
// rays depends on options.rays, not on options.threads. The set of a surface that no ray meets is
// empty.
std::vector<RaySet> arriving_rays(const TraceableScene& scene, const RigidTransform& lab_from_body,
                                  std::span<const Beam> beams,
                                  std::span<const FluxMapReceiver* const> surfaces,
                                  TraceOptions options) {
  std::vector<HitBinner> binners;
  for (const FluxMapReceiver* surface : surfaces) {
    binners.emplace_back(scene.scene(), surface->grid());
  }
  // [part of the work][surface]: joined in the order of the parts, so that the file does not depend
  // on the number of threads.
  std::vector<std::vector<std::vector<RaySet::Ray>>> parts(trace_parts(options));
  for (auto& part : parts) part.resize(surfaces.size());
  options.observe = [&](const HitOrigin& origin, const Hits& hits) {
    const auto binned = std::make_unique<BinnedHits>();
    const Beam& beam = beams[origin.beam];
    for (size_t s = 0; s < surfaces.size(); ++s) {
      binners[s].bin(hits, *binned);
      keep(hits, *binned, wavelength_m(beam), 1.0 / options.replicates, parts[origin.part][s]);
    }
  };
  trace(scene, lab_from_body, beams, {}, options);
  std::vector<RaySet> sets(surfaces.size());
  for (size_t s = 0; s < surfaces.size(); ++s) {
    sets[s].format = "TM-25-13";
    sets[s].name = "light on " + surfaces[s]->name();
    for (auto& part : parts) {
      sets[s].rays.insert(sets[s].rays.end(), part[s].begin(), part[s].end());
      part[s] = {};
    }
    if (sets[s].rays.empty()) continue;
    sets[s].stated_radiant_flux_W = sets[s].ray_flux();
  }
  return sets;
}

std::vector<const FluxMapReceiver*> flux_maps(const Experiment& experiment) {
  std::vector<const FluxMapReceiver*> maps;
  for (const NamedReceiver& named : experiment.receivers) {
    if (named.flux_map) maps.push_back(named.flux_map.get());
  }
  return maps;
}

// Checked before the trace.
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

// Files of the rays that arrive on each flux map, if the experiment enables them.
std::vector<RunFile> ray_files(const OpticalRun& run, int threads) {
  const Experiment& experiment = run.experiment();
  const std::optional<uint64_t>& rays = experiment.file.effort.arriving_rays;
  if (!rays) return {};
  const std::vector<const FluxMapReceiver*> maps = flux_maps(experiment);
  TraceOptions options = experiment.file.trace;
  options.rays = *rays;
  options.replicates = 8;  // whose spread is not used
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

TraceRun run_trace(const RunOptions& options, const Console& console, bool with_files) {
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

namespace photorque::verbs::trace {
namespace {

RunResult run(const CommandOptions& options, const Console& console) {
  TraceRun run = run_trace(options, console);
  if (options.page) {
    run.result.files.push_back(light_page(*run.run, run.light, run.result, page_head(options)));
  }
  return std::move(run.result);
}

}  // namespace

Verb kind() {
  return {"trace",
          "Irradiance on every receiver, power balance, radiation force and torque",
          command_that_writes(traced_page_options, run),
          {"scene", "material", "source", "receiver", "joint", "attitude", "trace", "published",
           "effect"},
          "[scene] and [[source]]",
          [](const RunOptions& options) { return run_trace(options, Console(), false).result; }};
}

}  // namespace photorque::verbs::trace
