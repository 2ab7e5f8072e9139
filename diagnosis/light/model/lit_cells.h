// The cells of an array one by one: their voltages by what they do not carry of their light.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "photovoltaics/cell/model.h"
#include "photovoltaics/cell/one_diode.h"
#include "photovoltaics/cell/table.h"

namespace photorque {

// V_d(j) and its derivatives of one kind of cell at one temperature.
class LitDiode {
 public:
  LitDiode(const CellParameters& parameters, double extra_shunt_S);
  // From a table, where many points are asked for at one temperature; a cell of one diode without
  // breakdown needs none.
  LitDiode(const CellParameters& parameters, std::shared_ptr<const DiodeVoltageTable> table);
  double series_ohm() const { return series_ohm_; }

  struct Point {
    double value_V = 0.0, slope_ohm = 0.0, curvature_V_A2 = 0.0;
  };
  // At a dark current of either sign.
  Point at(double dark_A) const;

 private:
  CellCurve curve_;
  double series_ohm_;
  std::optional<OneDiode> plain_;  // one diode, no breakdown
  std::shared_ptr<const DiodeVoltageTable> table_;
};

struct NetworkSettings {
  double series_ohm = 0.0;                        // of the whole array
  double shunt_S = 0.0;                           // across every cell, beside its own
  double cell_offset_V = 0.0;                     // added to every cell's voltage
  std::vector<bool> string_open, bypass_shorted;  // may be empty
};

// The kinds of cells of an array at one temperature, without effects on them.
struct LitCells {
  std::vector<LitDiode> kinds;
  std::vector<int> kind_of_cell;
};
// `models`: of each cell. `tabulated`: worth its time where hundreds of points follow.
LitCells lit_cells(const std::vector<const CellModel*>& models, const std::vector<double>& area_m2,
                   double temperature_K, double extra_shunt_S, bool tabulated);

}  // namespace photorque
