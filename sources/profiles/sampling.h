// Area-preserving maps from uniform fractions to points on discs and directions on spheres,
// vectorised; sampling of polar angles from one plane of an intensity table.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "raytrace/emitter.h"

namespace photorque {

using FractionBlock = std::array<uint32_t, ray_block>;
using ValueBlock = std::array<float, ray_block>;
using VectorBlock = std::array<ValueBlock, 3>;

// Uniform points on a disc about the z axis at z = 0: radius from the square root of the first
// fraction, azimuth from the second. The map is polar, not concentric, so that every ring contains
// its exact fraction of a stratified set.
void fill_disc(double radius_m, const FractionBlock& radial, const FractionBlock& turn,
               VectorBlock& point_m);

// Unit vectors at 1 − cos θ = `rise` from the z axis, azimuth from a fraction. The norm is 1 to
// 2e-7; the relative precision is full down to the narrowest beams.
void fill_directions(const ValueBlock& rise, const FractionBlock& turn, VectorBlock& direction);

// Polar angles drawn from one plane of an intensity table.
//
// Method. The distribution is tabulated in cells so small that the intensity within them is linear
// in the rise 1 − cos θ to `cell_error` of the plane's flux. Every cell stores its exact flux
// (Gauss–Legendre with 8 nodes on cubics times a sine, exact to rounding). Within a cell a
// quadratic is inverted.

// 1 − cos θ with full relative precision near the axis.
inline double rise_at(double polar_rad) {
  const double sine = std::sin(0.5 * polar_rad);
  return 2.0 * sine * sine;
}

// Finds the item of a cumulative distribution: `before`, the fraction in the items before it, rises
// from item to item. A lookup table for equally spaced fractions shortens the search.
class FractionIndex {
 public:
  template <typename Item>
  void build(const std::vector<Item>& items, size_t slots) {
    first_.resize(slots);
    uint32_t item = 0;
    for (size_t k = 0; k < slots; ++k) {
      const double fraction = static_cast<double>(k) / static_cast<double>(slots);
      while (item + 1 < items.size() && items[item + 1].before <= fraction) ++item;
      first_[k] = item;
    }
  }
  // The item that contains a fraction ∈ (0, 1).
  template <typename Item>
  const Item& find(const std::vector<Item>& items, double fraction) const {
    size_t k = first_[static_cast<size_t>(fraction * static_cast<double>(first_.size()))];
    while (k + 1 < items.size() && items[k + 1].before <= fraction) ++k;
    return items[k];
  }

 private:
  std::vector<uint32_t> first_;
};

// Intensity between two polar angles of a plane: ≥ 0 and smooth, including both ends.
struct RadialPiece {
  double from_rad, to_rad;
  std::function<double(double polar_rad)> intensity;
};

// Distribution of the polar angle in one plane, for samples of equal weight.
class PlaneSampler {
 public:
  static constexpr double cell_error = 1e-8;

  // Knots of the plane's cubic: angles, intensities and slopes, equal in number.
  PlaneSampler(const std::vector<double>& polar_rad, const double* intensity, const double* slope);
  // A plane of adjoining pieces, rising.
  explicit PlaneSampler(const std::vector<RadialPiece>& pieces);

  // ∫ I sin θ dθ over the plane, ≥ 0.
  double flux() const { return flux_; }
  // 1 − cos θ below which a fraction ∈ (0, 1) of the flux lies. Requires flux() > 0.
  double rise(double fraction) const;

 private:
  struct Cell {
    double before;     // fraction of the flux below the cell
    double rise;       // of its lower edge
    double width;      // in rise
    double low, high;  // fraction per rise at its edges
  };
  struct Curve;
  template <typename Intensity>
  void add(const Intensity& intensity, double low_rad, double high_rad, double plane_flux,
           int depth);
  void find_fractions();

  double flux_ = 0.0;
  std::vector<Cell> cells_;
  FractionIndex index_;  // of the cells
};

}  // namespace photorque
