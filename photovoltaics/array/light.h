// Light on a grid, and its sums over the cells on the grid.
#pragma once

#include <span>
#include <vector>

#include "raytrace/receiver.h"
#include "receivers/flux_map.h"

namespace photorque {

// Incident power on a grid of bins. The bins of `power_W` [W] are bin · bands + band.
struct ArrayLight {
  SurfaceGrid grid;
  int bands = 1;
  BinSums power_W;
  // Sums of an IncidenceReceiver over the same grid, with the same number of replicates. Without
  // bins, all light counts as perpendicular.
  BinSums entry = {};
};

// The light that a flux map received; `entry`: the fraction that enters the cells.
ArrayLight array_light(const FluxMapReceiver& receiver, const BinSums& sums,
                       const BinSums& entry = {});

// Adds the light on the back of the same surface, of which `fraction` enters the cells at any
// angle. Throws InputError unless the grids are equal.
void add_back_light(ArrayLight& light, const ArrayLight& back, double fraction);

// A cell's active area in the grid's coordinates.
struct CellRectangle {
  double u_low = 0, u_high = 0, v_low = 0, v_high = 0;
};

// columns × rows equal rectangles, with `gap` between neighbours and `margin` around all, in units
// of the grid's coordinates; row-major, as bins. Throws InputError if gaps and margins leave no
// cell.
std::vector<CellRectangle> cell_rectangles(const SurfaceGrid& grid, int columns, int rows,
                                           double gap, double margin);

// A fraction of a bin's surface.
struct BinPart {
  uint32_t bin = 0;
  double fraction = 0.0;
};

// The parts of a grid's bins in a rectangle.
std::vector<BinPart> parts_of_rectangle(const CellRectangle& cell, const SurfaceGrid& grid);

// The bins that each cell covers, with the covered fraction of each. The light is assumed to be
// uniform within a bin.
class CellCover {
 public:
  // One list of parts per cell.
  CellCover(const ArrayLight& light, std::span<const std::vector<BinPart>> cells);

  size_t cells() const { return first_.size() - 1; }
  double area_m2(size_t cell) const { return area_m2_[cell]; }
  // Sum over the bins of each cell: cell · bands + band.
  std::vector<double> gather(std::span<const double> power_W) const;

 private:
  size_t bands_;
  std::vector<BinPart> parts_;
  std::vector<size_t> first_;  // parts of cell i: first_[i] … first_[i + 1] − 1
  std::vector<double> area_m2_;
};

}  // namespace photorque
