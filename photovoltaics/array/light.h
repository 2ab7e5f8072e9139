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
  // Sums of an IncidenceReceiver over the same grid, as many replicates; without bins, all light
  // enters the cells as perpendicular light does.
  BinSums entry = {};
};

// The light that a flux map received; `entry`: the fraction that enters the cells.
ArrayLight array_light(const FluxMapReceiver& receiver, const BinSums& sums,
                       const BinSums& entry = {});

// Adds `fraction` of the light on the back of the same surface. It enters as perpendicular light.
// InputError unless the grids are alike.
void add_back_light(ArrayLight& light, const ArrayLight& back, double fraction);

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

// A fraction of a bin's surface.
struct BinPart {
  uint32_t bin = 0;
  double fraction = 0.0;
};

// The parts of a grid's bins in a rectangle.
std::vector<BinPart> parts_of_rectangle(const CellRectangle& cell, const ArrayLight& light);

// Which bins each cell covers, and by what fraction of the bin. Light is taken as even within a
// bin.
class CellCover {
 public:
  CellCover(const ArrayLight& light, std::span<const CellRectangle> cells);
  // One list of parts per cell.
  CellCover(const ArrayLight& light, std::span<const std::vector<BinPart>> cells);

  size_t cells() const { return first_.size() - 1; }
  double area_m2(size_t cell) const { return area_m2_[cell]; }
  // Sum over the bins of each cell: cell · bands + band.
  std::vector<double> gather(std::span<const double> power_W) const;

 private:
  void add(const ArrayLight& light, std::span<const BinPart> parts);

  size_t bands_;
  std::vector<BinPart> parts_;
  std::vector<size_t> first_;  // parts of cell i: first_[i] … first_[i + 1] − 1
  std::vector<double> area_m2_;
};

}  // namespace photorque
