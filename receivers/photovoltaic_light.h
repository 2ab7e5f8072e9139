// Light on a grid, gathered by the cells that lie on it.
#pragma once

#include <span>
#include <vector>

#include "raytrace/receiver.h"
#include "receivers/flux_map.h"

namespace photorque {

// Incident power on a grid of bins. The bins of `power_W` [W] are
// (iv·width + iu)·bands + band; u and v rise with the index.
struct ArrayLight {
  int width = 0;
  int height = 0;
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;  // outer edges; metres, or of a texture
  int bands = 1;
  std::vector<double> area_m2;  // of surface per bin (without bands)
  BinSums power_W;
};

// What a flux map received.
ArrayLight array_light(const FluxMapReceiver& receiver, const BinSums& sums);

// The whole of a grid of given irradiance, exactly known: one replicate, one band.
ArrayLight array_light(int width, int height, double u_length_m, double v_length_m,
                       std::span<const double> irradiance_W_m2);

// A cell's active area in the grid's coordinates.
struct CellRectangle {
  double u_low = 0, u_high = 0, v_low = 0, v_high = 0;
};

// columns × rows equal rectangles, `gap` between neighbours and `margin` around them all, in units
// of the grid's coordinates; row-major, as bins. Throws InputError when gaps and margins leave no
// cell.
std::vector<CellRectangle> cell_rectangles(const ArrayLight& light, int columns, int rows,
                                           double gap, double margin);

// Which bins each cell covers, and by what fraction of the bin. Light is taken as even within a
// bin.
class CellCover {
 public:
  CellCover(const ArrayLight& light, std::span<const CellRectangle> cells);

  size_t cells() const { return first_.size() - 1; }
  double area_m2(size_t cell) const { return area_m2_[cell]; }
  // Sum over bins and bands of power × factor of the band, per cell.
  std::vector<double> gather(std::span<const double> power_W,
                             std::span<const double> band_factor) const;

 private:
  struct Part {
    uint32_t bin;
    double fraction;
  };
  size_t bands_;
  std::vector<Part> parts_;
  std::vector<size_t> first_;  // parts of cell i: first_[i] … first_[i + 1] − 1
  std::vector<double> area_m2_;
};

}  // namespace photorque
