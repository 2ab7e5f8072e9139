// The solar array of an experiment.
#pragma once

#include <optional>

#include "core/settings/settings.h"
#include "photovoltaics/array/heat.h"
#include "photovoltaics/array/places.h"
#include "photovoltaics/cell/front.h"
#include "photovoltaics/cell/model.h"
#include "photovoltaics/cell/response.h"
#include "photovoltaics/network/wiring.h"

namespace photorque {

// Of one cell or diode: far beyond what any current gets through, and so near that power keeps its
// digits.
inline constexpr Range series_ohm_range{0.0, 1e6, false, false};

// A cell that is not like the others.
struct CellOverride {
  int index = 0;
  CellModel model;
  double photocurrent_factor = 1.0;  // of the photocurrent of its light
};

// The array on one receiver: places, wiring and models of its cells.
struct ArrayDesign {
  int columns = 0;                   // cells along u of the receiver's grid
  int rows = 0;                      // and along v; cell = row · columns + column
  std::optional<CellPlaces> places;  // instead of equal rectangles over the whole grid
  double gap_m = 0.0;                // between neighbouring cells
  double margin_m = 0.0;
  ArrayWiring wiring;
  CellModel cell;
  std::vector<CellOverride> overrides;  // in the order of their cells, each once at most
  // At which the cells and their photocurrents are computed; where `heat` is stated a reference
  // that evaluate_array() replaces with the steady state.
  double temperature_K = 298.15;
  std::optional<CellHeat> heat = {};    // none: the cells stay at temperature_K
  double rated_temperature_K = 358.15;  // above it a warning
  QuantumEfficiency efficiency;
  std::optional<CellFront> front;  // over the surface's own optics

  int cells() const { return columns * rows; }
  // The override of a cell; null where it has none.
  const CellOverride* override_of(size_t cell_index) const;
};

// Regular wiring: the cells, taken serpentine-wise along columns (v) or rows (u) of the grid, are
// cut into `strings` equal strings and these into substrings of `bypass_every` cells, the last one
// shorter if need be. With `cross_tied` cells of equal place in all strings are tied in parallel
// and there is one string of such rows.
struct RegularWiring {
  bool along_columns = true;
  int strings = 1;
  int bypass_every = 20;
  bool cross_tied = false;
  Diode bypass;
  Diode blocking;
};
ArrayWiring regular_wiring(int columns, int rows, const RegularWiring& options);

// Reads the table `[array]`:
//
//   cells = [10, 10]         columns along u and rows along v of the receiver; required where
//                            `places` does not say where the cells are, see read_cell_places()
//   gap_m, margin_m          between cells and around them; default 0. On a grid over texture
//                            coordinates they are fractions of it.
//   series = "columns"       "columns" or "rows": the serpentine in which cells follow each other
//   strings = 1              parallel strings; must divide the number of cells
//   bypass_every = 20        cells per bypass diode; default: all cells of a string
//   cross_tied = false       tie cells of equal place in all strings
//   circuit = ["series 3 bypass", "parallel 2", "series 20"]   instead of strings, bypass_every and
//                            cross_tied: the serpentine in equal parts, level by level
//   wiring = [[[0, 1], [2, 3]]]   instead of the five keys above: strings of substrings of cells
//                            (a list in place of a cell is cells in parallel, a list in that is
//                            cells in series, and so on by turns)
//   bypass = "ideal"         "none", "ideal" (clamps at drop_V) or "junction"; default "ideal"
//   blocking = "none"        the same choices
//   [array.bypass_diode]     drop_V = 0.5, saturation_A = 1e-6, ideality = 1.05,
//                            series_ohm = 5e-3 (a small Schottky diode)
//   [array.blocking_diode]   the same, drop_V = 0
//   temperature_K            of the cells; not stated: 298.15, and see read_cell_heat()
//   rated_temperature_K      358.15
//   cell = "silicon_interdigitated"   one of known_cells()
//   [array.cell_parameters]  replaces single numbers of it: saturation_1_A, ideality_1,
//                            saturation_2_A, ideality_2, series_ohm, shunt_ohm, breakdown_fraction,
//                            breakdown_V, breakdown_exponent, reference_temperature_K, gap_eV,
//                            gap_slope_per_K, photocurrent_slope_per_K; and reference_area_m2, the
//                            area all of them belong to
//   [[array.cell_override]]  one cell that differs: index, photocurrent_factor (1), and the keys of
//                            [array.cell_parameters] but the temperature; what is not given is that
//                            of the other cells
//   quantum_efficiency_peak           of quantum_efficiency_of() the cell, or
//   [array.quantum_efficiency]        wavelength_m = […] (or _nm), efficiency = […]
//   [array.cover]                     see read_cell_front()
//
// Throws InputError for values out of range, and for a wiring or overrides that name a cell twice.
ArrayDesign read_array_design(const Settings& array, std::optional<CellPlaces> places = {});

}  // namespace photorque
