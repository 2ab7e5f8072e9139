// Power of a solar array from the light on its receiver.
#pragma once

#include <span>
#include <vector>

#include "core/product.h"
#include "photovoltaics/array/design.h"
#include "photovoltaics/array/light.h"
#include "photovoltaics/network/curve.h"

namespace photorque {

// Result of the array in the light of a trace. Standard errors are jackknife errors (Quenouille,
// Tukey): each replicate of the light is left out in turn. The powers of single replicates would be
// biased: the map of a single replicate is √R times noisier than the mean map, and noise between
// cells in series lowers the power.
struct ArrayResult {
  Estimate power_W;  // at the maximum power point
  Estimate voltage_V;
  Estimate current_A;
  Estimate power_on_cells_W;  // light on both faces
  // The light on the cells, weighted by the fraction that enters at its angle over the fraction
  // that enters at normal incidence, and on the back by the bifaciality.
  Estimate power_entering_W;
  bool entry_known = false;      // false: all light counts as perpendicular, nothing is subtracted
  Estimate sum_of_cells_W;       // sum of the cells' maximum powers
  Estimate efficiency;           // power_W / power_on_cells_W
  Estimate efficiency_of_cells;  // sum_of_cells_W / power_on_cells_W
  Estimate mismatch_loss;        // 1 − power_W / sum_of_cells_W: uneven light, and diodes
  double area_of_cells_m2 = 0.0;
  Estimate temperature_K;      // cell temperature: steady state, or as stated
  double power_per_K_W = 0.0;  // d power_W/dT of the cells, in the same light

  std::vector<double> cell_light_W;  // per cell, cell = row · columns + column
  std::vector<double> cell_area_m2;
  std::vector<Vec2> cell_centre_m;  // places of CellPlaces, or empty
  std::vector<double> cell_photocurrent_A;
  CellStates cells;                // at the maximum power point
  std::vector<ArrayPoint> maxima;  // all local maxima, by rising voltage
  std::vector<ArrayPoint> curve;   // short to open circuit
  int columns = 0, rows = 0;
};

// Evaluates the array in this light. `responsivity_A_W`: one per band of the light, see
// band_responsivity_A_W(). If `design.heat` is stated, the cells are in the steady state of this
// light at their maximum power point, and standard errors include the response of the temperature
// to the light. Throws InputError if the cells do not fit on the grid or cover none of the surface.
ArrayResult evaluate_array(const ArrayDesign& design, const ArrayLight& light,
                           std::span<const double> responsivity_A_W);

// Light and photocurrents of the cells, without the network: means over the replicates and, for
// several replicates, standard errors. cell_currents() throws InputError like evaluate_array().
struct CellCurrents {
  std::vector<double> photocurrent_A, photocurrent_error_A;
  Estimate power_on_cells_W;
  std::vector<double> area_m2;
};
CellCurrents cell_currents(const ArrayDesign& design, const ArrayLight& light,
                           std::span<const double> responsivity_A_W);

// Quantities; tables "iv" (voltage_V, current_A, power_W), "maxima" and "cells"; plots "iv" and
// "pv"; maps of irradiance, photocurrent, operating voltage and operating power per cell.
Product array_product(const ArrayResult& result);

// Converts photocurrents from the temperature `from_K` to `to_K`, by the slope of each cell's
// model.
std::vector<double> warmed(const ArrayDesign& design, std::vector<double> photocurrent_A,
                           double from_K, double to_K);

// Diode laws of the cells, a step of evaluate_array(). Cells of equal area share a law.
CellTables cell_tables(const ArrayDesign& design, std::span<const double> cell_area_m2,
                       double largest_photocurrent_A);

}  // namespace photorque
