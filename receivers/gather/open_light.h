// Light on bins that nothing can shade, by quadrature. For the files of this folder only.
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "receivers/gather/plane.h"

namespace photorque {

// Immutable; called from many threads at once.
class OpenLight {
 public:
  // For tiles of at most `tile_side` bins a side, halved as often as may be. `plane` must outlive
  // this.
  OpenLight(const GatherPlane& plane, int tile_side);

  // Adds the light of a lamp on all bins of a tile to `entries` [W], see GatherPlane::add_power().
  // `ball` holds the tile. Returns the number of bins with a surface.
  size_t add(const BinTile& tile, const Ball& ball, const GatherLamp& lamp,
             std::span<double> entries) const;

 private:
  // Chebyshev points a side, where they replace Gauss points in every bin.
  static constexpr size_t min_nodes = 4, max_nodes = 20;

  std::vector<double> interpolate(const BinTile& tile, size_t nodes, const GatherLamp& lamp) const;

  const GatherPlane& plane_;
  std::map<std::pair<size_t, size_t>, Eigen::MatrixXd> cell_means_;  // by nodes and cells
};

}  // namespace photorque
