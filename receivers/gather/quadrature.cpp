#include "receivers/gather/quadrature.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/numerics/interpolation.h"

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

ChebyshevTiles::ChebyshevTiles(const SurfaceGrid& grid) {
  // All tile sizes that halving produces.
  std::set<int> sizes;
  const std::function<void(int)> halve = [&](int side) {
    if (!sizes.insert(side).second || side < 2) return;
    halve(side / 2);
    halve(side - side / 2);
  };
  for (const BinTile& square : squares_of(grid)) {
    halve(square.columns);
    halve(square.rows);
  }
  for (size_t nodes = step; nodes <= max_nodes; nodes += step) {
    Rule& rule = rules_[nodes];
    const Eigen::MatrixXd coefficients = chebyshev_coefficients(nodes);
    rule.high_coefficients = coefficients.bottomRows(4);
    for (size_t i = 0; i < nodes; ++i) rule.fraction.push_back(chebyshev_fraction(nodes, i));
    for (const int side : sizes) {
      rule.cell_means[side] = chebyshev_term_means(nodes, static_cast<size_t>(side)) * coefficients;
    }
  }
}

std::vector<size_t> ChebyshevTiles::attempts(const BinTile& tile, double scales) const {
  constexpr size_t most_in_bin = 8, tries = 3;
  const auto count = static_cast<double>(tile.count());
  const size_t most = tile.count() == 1
                          ? most_in_bin
                          : std::min(max_nodes, static_cast<size_t>(4.0 * std::sqrt(count)));
  const auto wanted = static_cast<size_t>(4.0 + std::min(3.0 * scales, 100.0));
  std::vector<size_t> nodes;
  for (size_t n = (wanted + step - 1) / step * step; n <= most && nodes.size() < tries; n += step) {
    nodes.push_back(n);
  }
  return nodes;
}

Eigen::MatrixXd ChebyshevTiles::means_of(const BinTile& tile, const Eigen::MatrixXd& values,
                                         double& error) const {
  const Rule& rule = rules_.at(static_cast<size_t>(values.rows()));
  error += remainder_of(rule.high_coefficients * values) +
           remainder_of(rule.high_coefficients * values.transpose());
  return rule.cell_means.at(tile.columns) * values * rule.cell_means.at(tile.rows).transpose();
}

}  // namespace photorque
