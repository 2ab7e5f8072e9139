// Solar cells of a given area at a given temperature.
#pragma once

#include <string>
#include <vector>

#include "photovoltaics/cell/cell.h"

namespace photorque {

// E₀ and s of silicon: De Soto, see below.
inline constexpr double silicon_gap_eV = 1.121, silicon_gap_slope_1_K = -0.0002677;

// Range of temperatures at which cells are computed. Colder or hotter cells are computed at its
// limits.
inline constexpr double coldest_cell_K = 100.0, hottest_cell_K = 1000.0;

// The circuit of a cell of a known area at a known temperature, and its dependence on both.
//
// Temperature: I_i(T) = I_i(T₀) (T/T₀)³ exp(f_i (E(T₀)/kT₀ − E(T)/kT)), with f = 1 for the
// diffusion diode 1 and f = 1/2 for the recombination diode 2, and E(T) = E₀ (1 + s (T − T₀)). With
// s ≠ 0 and one diode this is W. De Soto, S. A. Klein, W. A. Beckman, Solar Energy 80, 78 (2006),
// eq. 13–14 (s = −0.0002677 /K for silicon); with s = 0, S. M. Sze, Physics of Semiconductor
// Devices, sec. 2.4. Resistances and breakdown are constant (a shunt may depend on the light, see
// in_light()). The photocurrent grows by a fraction per kelvin: about +4e-4 in sunlight, because
// the absorption edge moves; almost nothing for light far from the edge.
//
// Area: currents are proportional to it, resistances inversely proportional.
struct CellModel {
  CellParameters reference;  // at reference_area_m2; its temperature_K is T₀
  double reference_area_m2 = 1.0;
  double gap_eV = 1.121;       // E₀
  double gap_slope_1_K = 0.0;  // s
  double photocurrent_slope_1_K = 0.0;
};

// The circuit of a cell of `area_m2` > 0 at `temperature_K` > 0.
CellParameters parameters_at(const CellModel& model, double area_m2, double temperature_K);

// The circuit with a leak of `extra_S` ≥ 0 in parallel with the shunt. The breakdown current is
// unchanged.
CellParameters with_leak(CellParameters parameters, double extra_S);

// The photocurrent at a temperature over that at T₀; never negative.
double photocurrent_factor(const CellModel& model, double temperature_K);

// Cells known by name.
struct NamedCell {
  std::string name;
  std::string summary;
  CellModel model;
};
std::vector<NamedCell> known_cells();

}  // namespace photorque
