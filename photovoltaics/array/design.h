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

// Range for one cell or diode. The upper limit exceeds every real resistance and keeps rounding
// errors of the power small.
inline constexpr Range series_ohm_range{0.0, 1e6, false, false};

// A cell that differs from the others.
struct CellOverride {
  int index = 0;
  CellModel model;
  double photocurrent_factor = 1.0;  // factor on the photocurrent by the light
};

// The array on one receiver: places, wiring and models of its cells.
struct ArrayDesign {
  int columns = 0;                   // cells along u of the receiver's grid
  int rows = 0;                      // cells along v; cell = row · columns + column
  std::optional<CellPlaces> places;  // instead of equal rectangles over the whole grid
  double gap_m = 0.0;                // between neighbouring cells
  double margin_m = 0.0;
  ArrayWiring wiring;
  CellModel cell;
  std::vector<CellOverride> overrides;  // in the order of their cells, each once at most
  // Temperature at which the cells and their photocurrents are computed. If `heat` is stated, it is
  // only a reference that evaluate_array() replaces by the steady state.
  double temperature_K = 298.15;
  std::optional<CellHeat> heat = {};    // none: the cells stay at temperature_K
  double rated_temperature_K = 358.15;  // warning above it
  QuantumEfficiency efficiency;
  std::optional<CellFront> front;  // over the surface's own optics

  int cells() const { return columns * rows; }
  // The override of a cell; null if it has none.
  const CellOverride* override_of(size_t cell_index) const;
};

// Regular wiring. The cells are taken in a serpentine along columns (v) or rows (u) of the grid and
// cut into `strings` equal strings. These are cut into substrings of `bypass_every` cells; the last
// one may be shorter. With `cross_tied`, cells at equal positions of all strings are connected in
// parallel, and there is one string of such rows.
struct RegularWiring {
  bool along_columns = true;
  int strings = 1;
  int bypass_every = 20;
  bool cross_tied = false;
  Diode bypass;
  Diode blocking;
};
ArrayWiring regular_wiring(int columns, int rows, const RegularWiring& options);

// Reads the keys of array_design_keys() in the table `[array]`. `places` replaces the key `cells`;
// see read_cell_places(). Throws InputError for values out of range, and for a wiring or overrides
// that contain a cell twice.
ArrayDesign read_array_design(const Settings& array, std::optional<CellPlaces> places = {});

}  // namespace photorque
