// Assignment of hits to the bins of a surface grid, and estimates per bin.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "raytrace/receiver.h"
#include "receivers/surface_grid.h"

namespace photorque {

// The hits that count for a grid, as runs of neighbours, and their bins.
struct BinnedHits {
  struct Run {
    uint32_t begin, end;  // indices into Hits
  };
  int runs = 0;
  std::array<Run, Hits::capacity> run;
  std::array<uint32_t, Hits::capacity> bin;  // by index into Hits; valid only for hits that count
};

// Calls add(hit, bin) for all binned hits. Neighbours often share a bin, and each addition to it
// would wait for the one before. Four interleaved streams avoid this.
template <typename Add>
void for_each_binned(const BinnedHits& binned, const Add& add) {
  for (size_t r = 0; r < static_cast<size_t>(binned.runs); ++r) {
    const size_t begin = binned.run[r].begin, end = binned.run[r].end;
    size_t stride = (end - begin) / 4;
    if (stride % 64 == 0 && stride > 0) stride -= 8;  // else the streams share sets of the cache
    for (size_t i = begin; i < begin + stride; ++i) {
      for (size_t stream = 0; stream < 4; ++stream) {
        const size_t hit = i + stream * stride;
        add(hit, binned.bin[hit]);
      }
    }
    for (size_t hit = begin + 4 * stride; hit < end; ++hit) add(hit, binned.bin[hit]);
  }
}

// Estimates per bin of a grid, NaN in bins without surface, and of their total.
struct GridEstimates {
  std::vector<Estimate> per_bin;
  Estimate total;
};

// Estimates from bins whose first half is direct light and whose second half, in the same order, is
// bounced light. value(half, bin) is the value of a bin of the grid in one half.
template <typename Value>
GridEstimates estimates_on(const SurfaceGrid& grid, const BinSums& sums, const Value& value) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values(static_cast<size_t>(sums.replicates)), totals(values.size(), 0.0);
  double bounds = 0.0;
  GridEstimates found;
  for (size_t bin = 0; bin < grid.bins(); ++bin) {
    for (size_t r = 0; r < values.size(); ++r) {
      const auto all = sums.of(static_cast<int>(r));
      values[r] = value(all, bin) + value(all.subspan(sums.bins / 2), bin);
      totals[r] += values[r];
    }
    const double bound = sums.bound.empty() ? 0.0 : value(std::span(sums.bound), bin);
    bounds += bound;
    found.per_bin.push_back(grid.area_m2[bin] > 0.0
                                ? with_bound(estimate_from_replicates(values), bound)
                                : Estimate{nan, nan});
  }
  found.total = with_bound(estimate_from_replicates(totals), bounds);
  return found;
}

// Looks up hits in a grid. A hit counts if its instance belongs to the grid, its side counts and
// its triangle faces the requested direction. The position then gives the bin. Immutable; keeps the
// necessary parts of the scene.
class HitBinner {
 public:
  // `grid` must have been made for `scene`.
  HitBinner(const Scene& scene, const SurfaceGrid& grid);

  // Sets `out` to the runs and bins of the hits that count.
  void bin(const Hits& hits, BinnedHits& out) const;

 private:
  // A coordinate in units of cells: slope · position + offset.
  struct CellCoordinate {
    Vec3 slope = Vec3::Zero();
    double offset = 0.0;
    double last = 0.0;  // index of the last cell
  };

  void set_plane(const SurfaceGrid& grid);
  void collect(const Hits& hits, BinnedHits& out) const;
  void collect_turned(const Hits& hits, BinnedHits::Run all, BinnedHits& out) const;
  void bin_plane(const Hits& hits, BinnedHits& out) const;
  void bin_texture(const Hits& hits, BinnedHits& out) const;

  SurfaceGrid::Over over_;
  uint32_t width_;
  // Per instance of the scene: bit 1 is set if hits on the front count, bit 0 if hits on the back
  // count.
  std::vector<uint8_t> side_bits_;
  // Triangle t of instance i has its entry in the tables below at first_face_[i] + t.
  std::vector<uint32_t> first_face_;
  std::vector<uint8_t> turned_towards_;            // empty: all triangles count
  std::vector<std::array<Vec2, 3>> corner_cells_;  // texture: cell coordinates of the corners
  CellCoordinate column_, row_;                    // plane
};

}  // namespace photorque
