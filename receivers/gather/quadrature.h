// Quadrature of direct light: means over the bins of tiles from values at Chebyshev points, with an
// estimate of their error; means over triangles. For the files of this folder and below only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/numerics/interpolation.h"
#include "receivers/gather/plane.h"

namespace photorque {

// Immutable; called from many threads at once.
class ChebyshevTiles {
 public:
  // Tiles of at most `tile_side` bins a side, which are halved as often as possible.
  ChebyshevTiles(const SurfaceGrid& grid, int tile_side);

  // Points a side that are worth trying for a function with this many scales across the tile:
  // none where halving the tile, or another rule for a single bin, costs less.
  std::vector<size_t> attempts(const BinTile& tile, double scales) const;

  // Means over bins, column by row of the tile, and the remainder of the series: how much the terms
  // after the last add.
  template <typename Value>
  struct Means;
  // `function(column, row)` at places of the grid gives a number or a Vec3.
  template <typename Value, typename Function>
  Means<Value> interpolate(const BinTile& tile, size_t nodes, const Function& function) const;

 private:
  static constexpr size_t min_nodes = 4, max_nodes = 20;

  // Turns values at n points, rising, into means over cells and into the four highest coefficients.
  struct Rule {
    Eigen::MatrixXd cell_means, high_coefficients;
  };
  // Means of one component; adds its remainder to `error`.
  Eigen::MatrixXd means_of(const BinTile& tile, const Eigen::MatrixXd& values, double& error) const;

  std::map<std::pair<size_t, size_t>, Rule> rules_;  // by nodes and cells
};

template <>
struct ChebyshevTiles::Means<double> {
  Eigen::MatrixXd mean;
  double error = 0.0;
  double of(int column, int row) const { return mean(column, row); }
};
template <>
struct ChebyshevTiles::Means<Vec3> {
  std::array<Eigen::MatrixXd, 3> mean;
  double error = 0.0;
  Vec3 of(int column, int row) const {
    return {mean[0](column, row), mean[1](column, row), mean[2](column, row)};
  }
};

template <typename Value, typename Function>
ChebyshevTiles::Means<Value> ChebyshevTiles::interpolate(const BinTile& tile, size_t nodes,
                                                         const Function& function) const {
  constexpr size_t parts = std::is_same_v<Value, double> ? 1 : 3;
  const auto points = static_cast<Eigen::Index>(nodes);
  std::vector<double> fraction;
  for (size_t i = 0; i < nodes; ++i) fraction.push_back(chebyshev_fraction(nodes, i));
  std::array<Eigen::MatrixXd, parts> values;
  for (auto& part : values) part.resize(points, points);
  for (Eigen::Index j = 0; j < points; ++j) {
    for (Eigen::Index i = 0; i < points; ++i) {
      const Value value = function(tile.column + tile.columns * fraction[static_cast<size_t>(i)],
                                   tile.row + tile.rows * fraction[static_cast<size_t>(j)]);
      if constexpr (parts == 1) {
        values[0](i, j) = value;
      } else {
        for (size_t k = 0; k < parts; ++k) {
          values[k](i, j) = value[static_cast<Eigen::Index>(k)];
        }
      }
    }
  }
  Means<Value> means;
  if constexpr (parts == 1) {
    means.mean = means_of(tile, values[0], means.error);
  } else {
    for (size_t k = 0; k < parts; ++k) means.mean[k] = means_of(tile, values[k], means.error);
  }
  return means;
}

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
