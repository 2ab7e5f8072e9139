// Quadrature of direct light: means over the bins of tiles from values at Chebyshev points, with an
// estimate of their error; means over triangles. For the files of this folder and below only.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "core/numerics/interpolation.h"
#include "receivers/gather/plane.h"

namespace photorque {

// Immutable; called from many threads at once.
class ChebyshevTiles {
 public:
  // For tiles of `grid`, which are halved as often as possible.
  explicit ChebyshevTiles(const SurfaceGrid& grid);

  // Points a side that are worth trying for a function with this many scales across the tile:
  // none where halving the tile, or another rule for a single bin, costs less.
  std::vector<size_t> attempts(const BinTile& tile, double scales) const;

  // Places of the points along a side of a tile, in [0, 1].
  const std::vector<double>& fractions(size_t nodes) const { return rules_.at(nodes).fraction; }

  // Means over the bins, column by row of the tile, of the polynomial through values at the points,
  // likewise. Adds the remainder of the series to `error`: how much the terms after the last add.
  Eigen::MatrixXd means_of(const BinTile& tile, const Eigen::MatrixXd& values, double& error) const;

 private:
  static constexpr size_t step = 4, max_nodes = 32;

  // Turns values at n points, rising, into means over cells and into the four highest coefficients.
  struct Rule {
    std::vector<double> fraction;
    Eigen::MatrixXd high_coefficients;
    std::map<int, Eigen::MatrixXd> cell_means;  // by cells
  };

  std::map<size_t, Rule> rules_;  // by nodes
};

// The sum over the three points (a, b) as near to the corners of the triangle.
template <typename Function>
auto triangle_ring(const Function& f, double near) {
  const double far = 1.0 - 2.0 * near;
  auto sum = f(near, near);
  sum += f(far, near);
  sum += f(near, far);
  return sum;
}

// The mean over the triangle a, b ≥ 0, a + b ≤ 1, by the rule of degree 5 with seven points.
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
