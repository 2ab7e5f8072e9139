// Light on bins that nothing can shade, by quadrature. For the files of this folder only.
//
// Where the irradiance is smooth over a tile of bins, it is the polynomial through its values at
// Chebyshev points, whose last coefficients tell how far it is from the truth; where they tell too
// much, or an edge of a beam crosses the tile, the tile is halved. What is left in single bins is
// integrated along the outline of the surface in the bin (raytrace/direct/disc_light.h), which
// edges cut at known points.
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "receivers/gather/plane.h"

namespace photorque {

// Power and the bounds of its error, each in the direct entries of the flux map.
struct OpenEntries {
  std::span<double> power_W, bound_W;
};

// Immutable; called from many threads at once.
class OpenLight {
 public:
  // Aim for the error of a bin, over the lamp's typical irradiance (or, where less, over all of
  // the lamp's light).
  static constexpr double tolerance = 3e-7;

  // For tiles of at most `tile_side` bins a side, halved as often as may be. `plane` must outlive
  // this.
  OpenLight(const GatherPlane& plane, int tile_side);

  // Adds the light of a lamp on all bins of a tile to `entries`, see GatherPlane::add_power().
  // `ball` holds the tile. Returns the number of bins with a surface.
  size_t add(const BinTile& tile, const Ball& ball, const GatherLamp& lamp,
             const OpenEntries& entries) const;

 private:
  static constexpr size_t min_nodes = 4, max_nodes = 20;  // Chebyshev points a side

  // What the sides of bins add to their power, each for the two bins that share it; see
  // DiscLight::along_edge_W(). Of one lamp.
  using Sides = std::unordered_map<uint64_t, Integral<double>>;

  // Turns values at n Chebyshev points, rising, into means over cells and into the four highest
  // coefficients.
  struct Interpolation {
    Eigen::MatrixXd cell_means, high_coefficients;
  };
  struct TileMeans {
    Eigen::MatrixXd mean_W_m2;  // column by row of the tile
    double error_W_m2;
  };
  size_t add(const BinTile& tile, const Ball& ball, const GatherLamp& lamp, Sides& sides,
             const OpenEntries& entries) const;
  TileMeans interpolate(const BinTile& tile, size_t nodes, const GatherLamp& lamp) const;
  size_t add_smooth(const BinTile& tile, const TileMeans& means, const GatherLamp& lamp,
                    double tolerance_W_m2, const OpenEntries& entries) const;
  Integral<double> power_on_smooth_W(const SurfacePatch& patch, const GatherLamp& lamp,
                                     double tolerance_W_m2) const;
  Integral<double> power_W(const SurfacePatch& patch, const GatherLamp& lamp,
                           double tolerance_W_m2) const;
  Integral<double> power_W(int column, int row, const GatherLamp& lamp, double tolerance_W_m2,
                           Sides& sides) const;
  void add_patch(const Integral<double>& power_W, const SurfacePatch& patch, size_t bin,
                 const GatherLamp& lamp, const OpenEntries& entries) const;

  const GatherPlane& plane_;
  std::map<std::pair<size_t, size_t>, Interpolation> interpolations_;  // by nodes and cells
};

}  // namespace photorque
