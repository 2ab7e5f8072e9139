#include "tools/runs/arriving_rays.h"

#include <memory>

namespace photorque {
namespace {

// 0 where light has no one wavelength.
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

}  // namespace

std::vector<RaySet> arriving_rays(const TraceableScene& scene, const RigidTransform& lab_from_body,
                                  std::span<const Beam> beams,
                                  std::span<const FluxMapReceiver* const> surfaces,
                                  TraceOptions options) {
  std::vector<HitBinner> binners;
  for (const FluxMapReceiver* surface : surfaces) {
    binners.emplace_back(scene.scene(), surface->grid());
  }
  // [part of the work][surface]: parts in the order of their numbers make the same file at any
  // number of threads.
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

}  // namespace photorque
