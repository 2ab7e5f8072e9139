#include "receivers/photovoltaic_row.h"

#include <limits>

#include "receivers/photovoltaic_root.h"

namespace photorque {

ElementPoint tied_cells_at(std::span<const LitCell> cells, double current_A,
                           std::span<JunctionState> states) {
  // Were the current shared equally, the row's voltage would lie between its cells'.
  const double share_A = current_A / static_cast<double>(cells.size());
  double low_V = std::numeric_limits<double>::infinity(), high_V = -low_V, sum_V = 0.0;
  for (const LitCell& cell : cells) {
    JunctionState unused;
    const double v = cell_at(cell, share_A, unused).voltage_V;
    low_V = std::min(low_V, v);
    high_V = std::max(high_V, v);
    sum_V += v;
  }
  double conductance_S = 0.0, curvature_A_V2 = 0.0;
  const auto excess_A = [&](double voltage_V) {
    double sum_A = -current_A;
    conductance_S = curvature_A_V2 = 0.0;
    for (size_t i = 0; i < cells.size(); ++i) {
      const LitCell& cell = cells[i];
      const double i_A = cell.table->curve().current_A(cell.photocurrent_A, voltage_V);
      const ElementPoint point = cell_at(cell, i_A, states[i]);
      const double g = 1.0 / point.slope_ohm;
      sum_A += i_A;
      conductance_S += g;
      curvature_A_V2 += point.curvature_V_A2 * g * g * g;
    }
    return ValueAndSlope{sum_A, -conductance_S};
  };
  const double voltage_V =
      low_V < high_V
          ? falling_root(low_V, high_V, sum_V / static_cast<double>(cells.size()), 1e-9, excess_A)
          : low_V;
  if (!(low_V < high_V)) excess_A(low_V);
  const double slope = 1.0 / conductance_S;
  return {voltage_V, slope, curvature_A_V2 * slope * slope * slope};
}

SlopeRange tied_cells_range(std::span<const LitCell> cells, std::span<const JunctionState> high_v,
                            std::span<const JunctionState> low_v) {
  SlopeRange sum;
  for (size_t i = 0; i < cells.size(); ++i) {
    sum += inverted(cell_range(cells[i], high_v[i], low_v[i]));
  }
  return inverted(sum);
}

}  // namespace photorque
