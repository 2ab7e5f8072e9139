// Maximum power points of many single-diode cells, several at a time in vector registers.
#pragma once

#include <span>

namespace photorque {

// Arrays of equal length, one entry per cell: photocurrent I_L ≥ 0, saturation current I₀ > 0,
// thermal voltage n V_t > 0, series resistance R_s ≥ 0, shunt conductance 1/R_sh ≥ 0.
struct SingleDiodeCells {
  std::span<const double> photocurrent_A;
  std::span<const double> saturation_A;
  std::span<const double> scale_V;
  std::span<const double> series_ohm;
  std::span<const double> shunt_S;
};

// Writes voltage and current of every maximum power point; zero for cells in the dark.
//
// Method: Halley's iteration for dP/dV_d = 0 (cell.h) with a fixed number of steps
// from the closed form of the ideal cell, x + ln(1 + x) = ln(1 + I_L/I₀) with x = V_d/nV_t; a cell
// whose last step was not small enough is solved by the bracketed search instead, so that none
// fails. Accuracy: power to 1e-13 relative, voltage and current to 1e-10. Throws InputError when
// the arrays differ in length.
void maximum_power_points(const SingleDiodeCells& cells, std::span<double> voltage_V,
                          std::span<double> current_A);

}  // namespace photorque
