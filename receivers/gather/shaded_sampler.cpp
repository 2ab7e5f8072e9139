#include "receivers/gather/shaded_sampler.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "core/parallel.h"

namespace photorque {

Gathering::Gathering(const TraceableScene& scene, const RigidTransform& lab_from_body,
                     std::span<const Beam> beams, const SurfaceGrid& grid, Side side, int threads,
                     bool tables)
    : plane_(scene, grid, side),
      occluders_(occluders_above(scene.scene(), plane_.patches().point_m, plane_.normal())) {
  const RigidTransform body_from_lab = lab_from_body.inverse();
  const auto lights = lights_of(beams);
  for (size_t i = 0; i < beams.size(); ++i) {
    lamps_.emplace_back(beams[i], lights[i], body_from_lab, plane_);
  }
  if (tables) {
    for (const auto& light : std::set(lights.begin(), lights.end())) make_table(*light, threads);
  }
  std::vector<uint32_t> all(occluders_.size());
  std::iota(all.begin(), all.end(), 0u);
  const std::vector<BinTile> squares = squares_of(grid);
  sights_.resize(squares.size());
  parallel_for(squares.size(), threads, [&](size_t t) {
    for (uint32_t lamp = 0; lamp < lamps_.size(); ++lamp) {
      descend(squares[t], lamp, all, sights_[t]);
    }
  });
}

size_t Gathering::shaded_pairs() const {
  size_t pairs = 0;
  for (const TileSight& sight : sights_) pairs += sight.shaded.size();
  return pairs;
}

// Makes a table of a light for all its lamps above the plane, if it serves enough pairs.
void Gathering::make_table(const DiscLight& light, int threads) {
  constexpr size_t min_pairs = 2000;  // pairs of a bin and a lamp
  double low_m = INFINITY, high_m = 0.0;
  std::vector<GatherLamp*> served;
  for (GatherLamp& lamp : lamps_) {
    const auto [min_m, max_m] = lamp.heights_m(plane_);
    if (&lamp.light() != &light || !(min_m > 0.0)) continue;
    low_m = std::min(low_m, min_m);
    high_m = std::max(high_m, max_m);
    served.push_back(&lamp);
  }
  if (served.size() * plane_.grid().bins() < min_pairs) return;
  auto table = IrradianceTable::make(light, low_m, high_m, threads);
  if (!table) return;
  const auto shared = std::make_shared<const IrradianceTable>(*std::move(table));
  for (GatherLamp* lamp : served) lamp->use(shared);
}

// Splits a tile until nothing can shade it, something shades all of it, or it is one bin.
void Gathering::descend(const BinTile& tile, uint32_t index, std::span<const uint32_t> candidates,
                        TileSight& sight) const {
  const GatherLamp& lamp = lamps_[index];
  const Ball ball = plane_.ball_of(tile);
  if (lamp.misses(ball)) return;
  std::vector<uint32_t> occluders;
  if (!candidates.empty()) {
    const Shaft shaft(ball, lamp.aperture_ball(ball));
    for (const uint32_t candidate : candidates) {
      if (shaft.is_blocked_by(occluders_[candidate])) return;
      if (shaft.may_meet(occluders_[candidate])) occluders.push_back(candidate);
    }
  }
  if (lamp.lights_front() && occluders.empty()) {
    sight.open.push_back({tile, ball, index});
    return;
  }
  if (tile.count() == 1) {
    const size_t bin = plane_.bin_at(tile.column, tile.row);
    if (plane_.patches().of(bin).empty()) return;
    sight.shaded.push_back({static_cast<uint32_t>(bin), index});
    return;
  }
  for (const BinTile& half : tile.halves()) descend(half, index, occluders, sight);
}

bool is_gatherable(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams) {
  const bool apertures =
      std::all_of(beams.begin(), beams.end(), [](const Beam& b) { return b.aperture.has_value(); });
  return apertures && is_flat(scene, grid);
}

}  // namespace photorque
