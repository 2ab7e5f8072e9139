#include "receivers/gather/gather.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>

#include "core/errors.h"
#include "core/numerics/random.h"
#include "core/parallel.h"
#include "raytrace/surfaces/bsdf.h"
#include "receivers/gather/open_light.h"
#include "receivers/gather/plane.h"

namespace photorque {
namespace {

class Gather {
 public:
  Gather(const TraceableScene& scene, const RigidTransform& lab_from_body,
         std::span<const Beam> beams, const FluxMapReceiver& map, const GatherOptions& options)
      : plane_(scene, map),
        options_(options),
        triangles_(triangles_above(scene.scene(), plane_.patches().point_m, plane_.normal())),
        open_light_(plane_, tile_side),
        open_W_(map.direct_entries(), 0.0),
        open_bound_W_(map.direct_entries(), 0.0) {
    const RigidTransform body_from_lab = lab_from_body.inverse();
    // The LEDs of an array share one emitter and its tables.
    std::map<const Emitter*, std::shared_ptr<const DiscLight>> lights;
    for (const Beam& beam : beams) {
      auto& light = lights[beam.emitter.get()];
      if (!light) light = std::make_shared<DiscLight>(*beam.emitter, *beam.aperture);
      lamps_.emplace_back(beam, light, body_from_lab, plane_);
    }
    for (const auto& [emitter, light] : lights) make_table(*light);
    cut_into_tiles();
  }

  Gathered run() {
    find_occluders();
    shaded_.resize(tiles_.size());
    std::vector<size_t> open(tiles_.size(), 0);
    parallel_for(tiles_.size(), options_.threads, [&](size_t t) {
      for (uint32_t lamp = 0; lamp < lamps_.size(); ++lamp) {
        open[t] += descend(tiles_[t], lamp, occluders_[lamp], shaded_[t]);
      }
    });
    Gathered result;
    result.open_pairs = std::accumulate(open.begin(), open.end(), size_t{0});
    for (const auto& pairs : shaded_) result.shaded_pairs += pairs.size();
    for (int points = options_.points;; points *= 2) {
      result.direct = sample(points, result.shadow_rays);
      result.worst_error = worst_error(result.direct);
      const bool enough = result.worst_error <= options_.target_error;
      if (options_.target_error <= 0.0 || enough || 2 * points > max_points) break;
    }
    return result;
  }

 private:
  static constexpr int max_points = 1 << 14;
  static constexpr int tile_side = 16;  // bins

  // A table of a light for all its lamps above the plane, where it pays.
  void make_table(const DiscLight& light) {
    constexpr size_t min_pairs = 2000;  // of a bin and a lamp
    double low_m = INFINITY, high_m = 0.0;
    std::vector<GatherLamp*> served;
    for (GatherLamp& lamp : lamps_) {
      const auto [min_m, max_m] = lamp.heights_m(plane_);
      if (&lamp.light() != &light || !(min_m > 0.0)) continue;
      low_m = std::min(low_m, min_m);
      high_m = std::max(high_m, max_m);
      served.push_back(&lamp);
    }
    if (served.size() * plane_.map().grid().bins() < min_pairs) return;
    auto table = IrradianceTable::make(light, low_m, high_m, options_.threads);
    if (!table) return;
    const auto shared = std::make_shared<const IrradianceTable>(*std::move(table));
    for (GatherLamp* lamp : served) lamp->use(shared);
  }

  // Square tiles: the items of parallel work.
  void cut_into_tiles() {
    const SurfaceGrid& grid = plane_.map().grid();
    for (int row = 0; row < grid.height; row += tile_side) {
      for (int column = 0; column < grid.width; column += tile_side) {
        tiles_.push_back({column, row, std::min(tile_side, grid.width - column),
                          std::min(tile_side, grid.height - row)});
      }
    }
  }

  // Of every lamp, what may shade any bin.
  void find_occluders() {
    const SurfaceGrid& grid = plane_.map().grid();
    std::vector<uint32_t> all(triangles_.size());
    std::iota(all.begin(), all.end(), 0u);
    occluders_.resize(lamps_.size());
    parallel_for(lamps_.size(), options_.threads, [&](size_t lamp) {
      occluders_[lamp] =
          in_shaft(plane_.ball_of({0, 0, grid.width, grid.height}), lamps_[lamp], all);
    });
  }

  std::vector<uint32_t> in_shaft(const Ball& ball, const GatherLamp& lamp,
                                 std::span<const uint32_t> candidates) const {
    std::vector<uint32_t> kept;
    if (candidates.empty()) return kept;
    const Shaft shaft(ball, lamp.aperture_ball(ball));
    for (const uint32_t t : candidates) {
      if (shaft.may_meet(triangles_[t])) kept.push_back(t);
    }
    return kept;
  }

  // Splits a tile until nothing can shade it, or it is one bin. Returns the number of open bins.
  size_t descend(const BinTile& tile, uint32_t index, std::span<const uint32_t> candidates,
                 std::vector<ShadedPair>& shaded) {
    const GatherLamp& lamp = lamps_[index];
    const Ball ball = plane_.ball_of(tile);
    if (lamp.misses(ball)) return 0;
    const std::vector<uint32_t> occluders = in_shaft(ball, lamp, candidates);
    if (lamp.lights_front() && occluders.empty()) {
      return open_light_.add(tile, ball, lamp, {open_W_, open_bound_W_});
    }
    if (tile.count() == 1) {
      const size_t bin = plane_.bin_at(tile.column, tile.row);
      if (!plane_.patches().of(bin).empty()) shaded.push_back({static_cast<uint32_t>(bin), index});
      return 0;
    }
    const auto [low, high] = tile.halves();
    const size_t open = descend(low, index, occluders, shaded);
    return open + descend(high, index, occluders, shaded);
  }

  BinSums sample(int points, uint64_t& rays) const {
    BinSums sums{plane_.map().direct_entries(), options_.replicates, {}, open_bound_W_};
    for (int r = 0; r < options_.replicates; ++r) {
      sums.sums.insert(sums.sums.end(), open_W_.begin(), open_W_.end());
    }
    std::vector<uint64_t> counted(tiles_.size(), 0);
    parallel_for(tiles_.size(), options_.threads, [&](size_t tile) {
      const std::vector<ShadedPair>& pairs = shaded_[tile];
      for (size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
        const uint32_t lamp = pairs[begin].lamp;
        while (end < pairs.size() && pairs[end].lamp == lamp) ++end;
        for (int r = 0; r < options_.replicates; ++r) {
          const uint64_t which = hash_words(hash_words(lamp, tile), static_cast<uint64_t>(r));
          const auto entries =
              std::span(sums.sums).subspan(static_cast<size_t>(r) * sums.bins, sums.bins);
          counted[tile] +=
              sample_shaded(plane_, lamps_[lamp], std::span(pairs).subspan(begin, end - begin),
                            points, {options_.seed, which, 0}, entries);
        }
      }
    });
    rays += std::accumulate(counted.begin(), counted.end(), uint64_t{0});
    return sums;
  }

  // Largest relative standard error of the irradiance above the floor.
  double worst_error(const BinSums& sums) const {
    const FluxMapReceiver& map = plane_.map();
    const auto bands = static_cast<size_t>(map.bands().count());
    std::vector<Estimate> bins;
    std::vector<double> density(static_cast<size_t>(sums.replicates));
    double peak = 0.0;
    for (size_t bin = 0; bin < map.grid().bins(); ++bin) {
      const double area_m2 = map.grid().area_m2[bin];
      if (!(area_m2 > 0.0)) continue;
      for (size_t r = 0; r < density.size(); ++r) {
        const auto all = sums.of(static_cast<int>(r));
        density[r] = 0.0;
        for (size_t band = 0; band < bands; ++band) density[r] += all[map.entry(bin, band)];
        density[r] /= area_m2;
      }
      double bound_W = 0.0;
      for (size_t band = 0; band < bands; ++band) bound_W += sums.bound_of(map.entry(bin, band));
      bins.push_back(with_bound(estimate_from_replicates(density), bound_W / area_m2));
      peak = std::max(peak, bins.back().value);
    }
    double worst = 0.0;
    for (const Estimate& bin : bins) {
      if (bin.value > options_.floor * peak) {
        worst = std::max(worst, bin.standard_error / bin.value);
      }
    }
    return worst;
  }

  GatherPlane plane_;
  const GatherOptions& options_;
  std::vector<TriangleCorners> triangles_;
  std::vector<GatherLamp> lamps_;
  std::vector<std::vector<uint32_t>> occluders_;  // per lamp
  std::vector<BinTile> tiles_;
  OpenLight open_light_;
  std::vector<double> open_W_, open_bound_W_;
  std::vector<std::vector<ShadedPair>> shaded_;  // per tile, lamp by lamp
};

// What the surface absorbs depends on the angle of incidence (glass), which bins do not keep.
bool absorbs_by_angle(const Scene& scene, const SurfaceGrid& grid) {
  return std::any_of(grid.instances.begin(), grid.instances.end(), [&](uint32_t instance) {
    const Instance& of = scene.instances[instance];
    const uint32_t surface = grid.side == Side::back ? of.back_surface : of.front_surface;
    const Bsdf* bsdf = scene.surfaces[surface].bsdf.get();
    return bsdf != nullptr && bsdf->law != nullptr;
  });
}

}  // namespace

bool can_gather(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams) {
  const bool apertures =
      std::all_of(beams.begin(), beams.end(), [](const Beam& b) { return b.aperture.has_value(); });
  return apertures && grid.side != Side::both && is_flat(scene, grid) &&
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
  constexpr double worth = 4.0;  // times the rays, whose errors are far larger
  return gathering_cost_s(pairs) <= std::max(bearable_s, worth * tracing_cost_s(rays));
}

Gathered gather_direct(const TraceableScene& scene, const RigidTransform& lab_from_body,
                       std::span<const Beam> beams, const FluxMapReceiver& map,
                       const GatherOptions& options) {
  if (!can_gather(scene.scene(), map.grid(), beams)) {
    throw InputError({"gather"}, map.name(), "a surface or a source that needs rays",
                     "one side of a flat surface, and sources with uniform apertures");
  }
  const auto start = std::chrono::steady_clock::now();
  Gathered result = Gather(scene, lab_from_body, beams, map, options).run();
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace photorque
