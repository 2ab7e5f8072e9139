#include "receivers/gather/gather.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/errors.h"
#include "core/parallel.h"
#include "raytrace/surfaces/bsdf.h"
#include "receivers/gather/open_light.h"
#include "receivers/gather/shaded_sampler.h"

namespace photorque {
namespace {

// Largest relative standard error of the irradiance of bins above the floor.
double worst_error_of(const FluxMapReceiver& map, const BinSums& sums, double floor) {
  std::vector<Estimate> bins;
  std::vector<double> density(static_cast<size_t>(sums.replicates));
  double peak = 0.0;
  for (size_t bin = 0; bin < map.grid().bins(); ++bin) {
    const double area_m2 = map.grid().area_m2[bin];
    if (!(area_m2 > 0.0)) continue;
    // Incident power in all bands.
    const auto all_bands_W = [&](std::span<const double> entries) {
      double sum_W = 0.0;
      for (int band = 0; band < map.bands().count(); ++band) {
        sum_W += entries[map.entry(bin, static_cast<size_t>(band))];
      }
      return sum_W;
    };
    for (size_t r = 0; r < density.size(); ++r) {
      density[r] = all_bands_W(sums.of(static_cast<int>(r))) / area_m2;
    }
    const double bound_W_m2 = all_bands_W(sums.bound) / area_m2;
    bins.push_back(with_bound(estimate_from_replicates(density), bound_W_m2));
    peak = std::max(peak, bins.back().value);
  }
  double worst = 0.0;
  for (const Estimate& bin : bins) {
    if (bin.value > floor * peak) worst = std::max(worst, bin.standard_error / bin.value);
  }
  return worst;
}

Gathered gather_on(const Gathering& gathering, const FluxMapReceiver& map,
                   const GatherOptions& options) {
  constexpr int max_points = 1 << 14;
  const FluxEntries flux(gathering.plane(), map);
  const OpenLight open_light(gathering.plane(), flux);
  const std::vector<TileSight>& sights = gathering.sights();
  std::vector<double> open_W(map.direct_entries(), 0.0), bound_W(map.direct_entries(), 0.0);
  std::vector<size_t> open(sights.size(), 0);
  parallel_for(sights.size(), options.threads, [&](size_t t) {
    std::map<BinTile, OpenLight::Lamps> tiles;
    for (const OpenTile& tile : sights[t].open) {
      tiles[tile.tile].push_back(&gathering.lamp(tile.lamp));
    }
    for (const auto& [tile, lamps] : tiles) {
      open[t] += open_light.add(tile, lamps, {open_W, bound_W});
    }
  });
  Gathered result;
  result.open_pairs = std::accumulate(open.begin(), open.end(), size_t{0});
  result.shaded_pairs = gathering.shaded_pairs();
  for (int points = options.points;; points *= 2) {
    result.direct = {map.direct_entries(), options.replicates,
                     sample_shaded(gathering, flux, open_W, options, points, result.shadow_rays),
                     bound_W};
    result.worst_error = worst_error_of(map, result.direct, options.floor);
    const bool enough = result.worst_error <= options.target_error;
    if (options.target_error <= 0.0 || enough || 2 * points > max_points) return result;
  }
}

// Whether absorption depends on the angle of incidence (glass), which bins do not record.
bool absorbs_by_angle(const Scene& scene, const SurfaceGrid& grid) {
  return std::any_of(grid.instances.begin(), grid.instances.end(), [&](uint32_t instance) {
    const bool front = grid.side != Side::back;
    const Bsdf* bsdf = scene.surface(scene.instances[instance], front).bsdf.get();
    return bsdf != nullptr && bsdf->law != nullptr;
  });
}

}  // namespace

bool can_gather(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams) {
  return grid.side != Side::both && is_gatherable(scene, grid, beams) &&
         !absorbs_by_angle(scene, grid);
}

double gathering_cost_s(size_t pairs) {
  return 1e-7 * static_cast<double>(pairs);
}

double tracing_cost_s(uint64_t rays) {
  return 9e-8 * static_cast<double>(rays);
}

bool gathering_pays(size_t pairs, uint64_t rays) {
  constexpr double bearable_s = 2.0;
  constexpr double worth = 4.0;  // accepted ratio to the time of rays, whose errors are far larger
  return gathering_cost_s(pairs) <= std::max(bearable_s, worth * tracing_cost_s(rays));
}

Gathered gather_direct(const TraceableScene& scene, const RigidTransform& lab_from_body,
                       std::span<const Beam> beams, const FluxMapReceiver& map,
                       const GatherOptions& options) {
  if (!can_gather(scene.scene(), map.grid(), beams)) {
    throw InputError({"gather"}, map.name(), "a surface or a source that needs rays",
                     "one side of a flat surface, and sources with uniform apertures");
  }
  const Gathering gathering(scene, lab_from_body, beams, map.grid(), map.grid().side,
                            options.threads, true);
  return gather_on(gathering, map, options);
}

}  // namespace photorque
