// Quadrature of direct light: means over the bins of tiles from values at Chebyshev points, with an
// error estimate; means over triangles. For the files of this folder and below only.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "receivers/gather/plane.h"

namespace photorque {

// Immutable; called from many threads at once.
class ChebyshevTiles {
 public:
  // For tiles of `grid`, halved any number of times.
  explicit ChebyshevTiles(const SurfaceGrid& grid);

  // Numbers of points per side to try for a function with this many scale lengths across the tile.
  // Empty if halving the tile, or another rule for a single bin, costs less.
  std::vector<size_t> attempts(const BinTile& tile, double scales) const;

  // Positions of the points along a side of a tile, in [0, 1].
  const std::vector<double>& fractions(size_t nodes) const { return rules_.at(nodes).fraction; }

  // Means over the bins, column by row of the tile, of the polynomial through `values` at the
  // points (column by row). Adds the estimated remainder of the series to `error`.
  Eigen::MatrixXd means_of(const BinTile& tile, const Eigen::MatrixXd& values, double& error) const;

 private:
  static constexpr size_t step = 4, max_nodes = 32;

  // Maps values at n points, rising, to means over cells and to the four highest coefficients.
  struct Rule {
    std::vector<double> fraction;
    Eigen::MatrixXd high_coefficients;
    std::map<int, Eigen::MatrixXd> cell_means;  // by number of cells
  };

  std::map<size_t, Rule> rules_;  // by number of points
};

// Sum over the three points with the coordinates (near, near), (far, near) and (near, far), where
// far = 1 − 2 near.
template <typename Function>
auto triangle_ring(const Function& f, double near) {
  const double far = 1.0 - 2.0 * near;
  auto sum = f(near, near);
  sum += f(far, near);
  sum += f(near, far);
  return sum;
}

// Mean over the triangle a, b ≥ 0, a + b ≤ 1, by the rule of degree 5 with seven points.
// Source: A. H. Stroud, Approximate Calculation of Multiple Integrals (1971), T2: 5-1.
template <typename Function>
auto triangle_mean(const Function& f) {
  constexpr double inner = 0.47014206410511509, inner_weight = 0.13239415278850618;
  constexpr double outer = 0.10128650732345634, outer_weight = 0.12593918054482715;
  constexpr double third = 1.0 / 3.0;
  auto mean = f(third, third);
  mean *= 0.225;
  mean += inner_weight * triangle_ring(f, inner);
  mean += outer_weight * triangle_ring(f, outer);
  return mean;
}

}  // namespace photorque
