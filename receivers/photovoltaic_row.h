// Cells tied in parallel, as one element of a string.
#pragma once

#include <cstdint>
#include <span>

#include "receivers/photovoltaic_slope.h"
#include "receivers/photovoltaic_table.h"

namespace photorque {

struct LitCell {
  const DiodeVoltageTable* table = nullptr;
  double photocurrent_A = 0.0;
  double series_ohm = 0.0;
};

// A two-terminal element at a current.
struct ElementPoint {
  double voltage_V = 0.0;
  double slope_ohm = 0.0;       // −dV/dI ≥ 0
  double curvature_V_A2 = 0.0;  // d²V/dI²
};

// What bounds over an interval need to know of one junction at each end.
struct JunctionState {
  double slope_ohm = 0.0;            // dV_d/dj
  double dark_curvature_A_V2 = 0.0;  // D″(V_d)
};

// One cell at a current of either sign.
inline ElementPoint cell_at(const LitCell& cell, double current_A, JunctionState& state) {
  const DiodeVoltage v = cell.table->at(cell.photocurrent_A - current_A);
  const double conductance_S = 1.0 / v.slope_ohm;
  state = {v.slope_ohm, -v.curvature_V_A2 * conductance_S * conductance_S * conductance_S};
  return {v.value_V - current_A * cell.series_ohm, v.slope_ohm + cell.series_ohm, v.curvature_V_A2};
}

// Bounds on V(I) of one cell between two states; `high_v` at the higher diode voltage.
inline SlopeRange cell_range(const LitCell& cell, const JunctionState& high_v,
                             const JunctionState& low_v) {
  double low = high_v.slope_ohm, high = low_v.slope_ohm;
  if (low > high) std::swap(low, high);
  if (high_v.dark_curvature_A_V2 > 0 && low_v.dark_curvature_A_V2 < 0) {
    high = cell.table->largest_slope_ohm();
  }
  const double low3 = low * low * low, high3 = high * high * high;
  const double least = -high_v.dark_curvature_A_V2, most = -low_v.dark_curvature_A_V2;
  return {low + cell.series_ohm, high + cell.series_ohm, least * (least < 0 ? high3 : low3),
          most * (most > 0 ? high3 : low3)};
}

// Cells tied in parallel at a total current; `states` has one entry per cell.
ElementPoint tied_cells_at(std::span<const LitCell> cells, double current_A,
                           std::span<JunctionState> states);
// Bounds on V(I) of the whole row.
SlopeRange tied_cells_range(std::span<const LitCell> cells, std::span<const JunctionState> high_v,
                            std::span<const JunctionState> low_v);

}  // namespace photorque
