#include "receivers/gather/quadrature.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

namespace photorque {
namespace {

// Remainder of a truncated Chebyshev series, from its four highest coefficients (rows) for any
// number of series (columns). The coefficients are assumed to decrease further at the same rate.
double remainder_of(const Eigen::MatrixXd& highest) {
  double worst = 0.0;
  for (Eigen::Index k = 0; k < highest.cols(); ++k) {
    const double before = highest.col(k).head<2>().cwiseAbs().maxCoeff();
    const double last = highest.col(k).tail<2>().cwiseAbs().maxCoeff();
    const double ratio = before > 0.0 ? std::min(last / before, 0.9) : 0.9;
    worst = std::max(worst, 2.0 * last * ratio / (1.0 - ratio));
  }
  return worst;
}

}  // namespace

ChebyshevTiles::ChebyshevTiles(const SurfaceGrid& grid, int tile_side) {
  // All sizes of tiles that halving leads to.
  std::set<int> sizes;
  const std::function<void(int)> halve = [&](int side) {
    if (!sizes.insert(side).second || side < 2) return;
    halve(side / 2);
    halve(side - side / 2);
  };
  for (const int bins : {grid.width, grid.height}) {
    halve(std::min(bins, tile_side));
    if (bins > tile_side && bins % tile_side > 0) halve(bins % tile_side);
  }
  for (const int side : sizes) {
    for (size_t nodes = min_nodes; nodes <= max_nodes; ++nodes) {
      const auto cells = static_cast<size_t>(side);
      rules_[{nodes, cells}] = {chebyshev_cell_means(nodes, cells),
                                chebyshev_coefficients(nodes).bottomRows(4)};
    }
  }
}

std::vector<size_t> ChebyshevTiles::attempts(const BinTile& tile, double scales) const {
  constexpr size_t most_in_bin = 8, step = 2, tries = 3;
  const auto count = static_cast<double>(tile.count());
  const size_t most = tile.count() == 1
                          ? most_in_bin
                          : std::min(max_nodes, static_cast<size_t>(4.0 * std::sqrt(count)));
  const auto fewest = min_nodes + static_cast<size_t>(std::min(3.0 * scales, 100.0));
  std::vector<size_t> nodes;
  for (size_t n = fewest; n <= most && nodes.size() < tries; n += step) nodes.push_back(n);
  return nodes;
}

Eigen::MatrixXd ChebyshevTiles::means_of(const BinTile& tile, const Eigen::MatrixXd& values,
                                         double& error) const {
  const auto nodes = static_cast<size_t>(values.rows());
  const Rule& across = rules_.at({nodes, static_cast<size_t>(tile.columns)});
  const Rule& along = rules_.at({nodes, static_cast<size_t>(tile.rows)});
  error += remainder_of(across.high_coefficients * values) +
           remainder_of(along.high_coefficients * values.transpose());
  return across.cell_means * values * along.cell_means.transpose();
}

}  // namespace photorque
