#include "receivers/gather/open_light.h"

#include <algorithm>
#include <functional>
#include <set>

#include "core/numerics/chebyshev.h"

namespace photorque {
namespace {

// 2 × 2 Gauss points, or the three-point rule of degree 2.
double mean_irradiance_W_m2(const SurfacePatch& patch, const GatherLamp& lamp) {
  const auto irradiance = [&](double a, double b) {
    return lamp.irradiance_W_m2(patch.origin_m + a * patch.edge1_m + b * patch.edge2_m);
  };
  constexpr double third = 1.0 / 3.0, sixth = 1.0 / 6.0;
  if (patch.triangle) {
    return third *
           (irradiance(sixth, sixth) + irradiance(4 * sixth, sixth) + irradiance(sixth, 4 * sixth));
  }
  constexpr double low = 0.21132486540518712, high = 1.0 - low;
  return 0.25 * (irradiance(low, low) + irradiance(high, low) + irradiance(low, high) +
                 irradiance(high, high));
}

}  // namespace

OpenLight::OpenLight(const GatherPlane& plane, int tile_side) : plane_(plane) {
  // All sizes of tiles that halving leads to.
  std::set<int> sizes;
  const std::function<void(int)> halve = [&](int side) {
    if (!sizes.insert(side).second || side < 2) return;
    halve(side / 2);
    halve(side - side / 2);
  };
  const SurfaceGrid& grid = plane.map().grid();
  for (const int bins : {grid.width, grid.height}) {
    halve(std::min(bins, tile_side));
    if (bins > tile_side && bins % tile_side > 0) halve(bins % tile_side);
  }
  const auto largest = static_cast<size_t>(tile_side);
  for (const int cells : sizes) {
    for (size_t nodes = min_nodes; nodes <= max_nodes; ++nodes) {
      if (nodes * nodes >= 4 * largest * largest) break;
      cell_means_[{nodes, static_cast<size_t>(cells)}] =
          chebyshev_cell_means(nodes, static_cast<size_t>(cells));
    }
  }
}

size_t OpenLight::add(const BinTile& tile, const Ball& ball, const GatherLamp& lamp,
                      std::span<double> entries) const {
  // Fewer points than two Gauss points a side of every bin, where the irradiance is smooth.
  const double turns = 2.0 * ball.radius_m / lamp.scale_m(ball);
  const auto nodes = min_nodes + static_cast<size_t>(std::min(4.0 * turns, 100.0));
  const auto count = static_cast<size_t>(tile.count());
  const bool smooth = nodes <= max_nodes && nodes * nodes < 4 * count && lamp.smooth_over(ball);
  std::vector<double> mean_W_m2;
  if (smooth) mean_W_m2 = interpolate(tile, nodes, lamp);
  size_t open = 0, at = 0;
  for (int row = tile.row; row < tile.row + tile.rows; ++row) {
    for (int column = tile.column; column < tile.column + tile.columns; ++column, ++at) {
      const size_t bin = plane_.bin_at(column, row);
      for (const SurfacePatch& patch : plane_.patches().of(bin)) {
        const double mean =
            smooth && plane_.whole(bin) ? mean_W_m2[at] : mean_irradiance_W_m2(patch, lamp);
        plane_.add_power(patch.area_m2 * mean, lamp.fraction(), bin, patch.instance, entries);
      }
      open += plane_.patches().of(bin).empty() ? 0 : 1;
    }
  }
  return open;
}

// Mean irradiance of the whole bins of a tile, row by row, from its values at nodes × nodes
// Chebyshev points.
std::vector<double> OpenLight::interpolate(const BinTile& tile, size_t nodes,
                                           const GatherLamp& lamp) const {
  const auto columns = static_cast<size_t>(tile.columns), rows = static_cast<size_t>(tile.rows);
  const Eigen::MatrixXd& across = cell_means_.at({nodes, columns});
  const Eigen::MatrixXd& along = cell_means_.at({nodes, rows});
  std::vector<double> fraction;
  for (size_t i = 0; i < nodes; ++i) fraction.push_back(chebyshev_fraction(nodes, i));
  Eigen::MatrixXd values(nodes, nodes);
  for (size_t j = 0; j < nodes; ++j) {
    for (size_t i = 0; i < nodes; ++i) {
      const Vec3 at = plane_.point_m(tile.column + tile.columns * fraction[i],
                                     tile.row + tile.rows * fraction[j]);
      values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = lamp.irradiance_W_m2(at);
    }
  }
  const Eigen::MatrixXd means = across * values * along.transpose();
  return {means.data(), means.data() + means.size()};  // columns of the tile fastest
}

}  // namespace photorque
