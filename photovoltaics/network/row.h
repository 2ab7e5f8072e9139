// Cells tied in parallel, as one element of a string.
#pragma once

#include <algorithm>
#include <span>

#include "photovoltaics/cell/diode_voltage.h"
#include "photovoltaics/cell/slope.h"

namespace photorque {

// `copies` like cells in series; 1 in a row.
struct LitCell {
  const DiodeVoltageLaw* law = nullptr;
  double photocurrent_A = 0.0;
  double series_ohm = 0.0;
  double copies = 1.0;
  double offset_V = 0.0;  // added to the voltage of each
};

// A two-terminal element at a current.
struct ElementPoint {
  double voltage_V = 0.0;
  double slope_ohm = 0.0;       // −dV/dI ≥ 0
  double curvature_V_A2 = 0.0;  // d²V/dI²
  double third_V_A3 = 0.0;      // d³V/dI³

  // Elements in series.
  ElementPoint& operator+=(const ElementPoint& other) {
    voltage_V += other.voltage_V;
    slope_ohm += other.slope_ohm;
    curvature_V_A2 += other.curvature_V_A2;
    third_V_A3 += other.third_V_A3;
    return *this;
  }
  Slopes slopes() const { return {slope_ohm, curvature_V_A2, third_V_A3}; }
};

// One cell at a current of either sign.
inline ElementPoint cell_at(const LitCell& cell, double current_A, JunctionState& state) {
  const DiodeVoltage v = cell.law->at(cell.photocurrent_A - current_A);
  state = {v.slope_ohm, v.curvature_V_A2};
  return {v.value_V + cell.offset_V - current_A * cell.series_ohm, v.slope_ohm + cell.series_ohm,
          v.curvature_V_A2, -v.third_V_A3};
}

// Bounds on V(I) of one cell between two states; `high_v` at the higher diode voltage.
//
// With r = dV_d/dj = 1/D′ the curvature is −D″ r³, and D″ is monotone: over the interval it lies
// between −D″(high_v) r³ and −D″(low_v) r³ for some r of the interval.
inline SlopeRange cell_range(const LitCell& cell, const JunctionState& high_v,
                             const JunctionState& low_v) {
  const double low = std::min(high_v.slope_ohm, low_v.slope_ohm);
  const double high = high_v.curvature_V_A2 < 0 && low_v.curvature_V_A2 > 0
                          ? cell.law->largest_slope_ohm()
                          : std::max(high_v.slope_ohm, low_v.slope_ohm);
  const double min_r = (high_v.curvature_V_A2 < 0 ? high : low) / high_v.slope_ohm;
  const double max_r = (low_v.curvature_V_A2 > 0 ? high : low) / low_v.slope_ohm;
  return {low + cell.series_ohm, high + cell.series_ohm,
          high_v.curvature_V_A2 * min_r * min_r * min_r,
          low_v.curvature_V_A2 * max_r * max_r * max_r};
}

// I(V) beyond a point from V(I) and its derivatives there: a straight line and an exponential, as a
// shunt and a diode have it; to third order any curve.
double extrapolated_A(const ElementPoint& at, double current_A, double voltage_V);

// Cells tied in parallel at a total current; `states` has one entry per cell.
ElementPoint tied_cells_at(std::span<const LitCell> cells, double current_A,
                           std::span<JunctionState> states);
// Bounds on V(I) of the whole row.
SlopeRange tied_cells_range(std::span<const LitCell> cells, std::span<const JunctionState> high_v,
                            std::span<const JunctionState> low_v);

}  // namespace photorque
