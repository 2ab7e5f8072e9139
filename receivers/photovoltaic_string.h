// One string of an array under given light: V as an explicit function of I.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "receivers/photovoltaic_row.h"
#include "receivers/photovoltaic_wiring.h"

namespace photorque {

using CellTables = std::vector<std::shared_ptr<const DiodeVoltageTable>>;

// A point of a string's curve, with what the bounds between two points need. Reused between
// evaluations to spare allocations.
struct StringState {
  double current_A = 0.0;
  double voltage_V = 0.0;
  double slope_ohm = 0.0;       // −dV/dI; ∞ for a blocked string
  double curvature_V_A2 = 0.0;  // d²V/dI²
  std::vector<JunctionState> cells;
  std::vector<double> bypass_V;  // voltages of the bypass junctions, warm starts of their solve
  std::vector<double> bypass_S;  // conductances of these junctions without R_s
  double blocking_ohm = 0.0;     // of the blocking junction, without R_s
};

// Which ideal diodes conduct. Over a piece of the curve on which this does not change, the string
// is a smooth element.
struct StringRegime {
  std::vector<char> clamped;  // per substring: its bypass carries the current
  bool blocked = false;       // the blocking diode carries none
};

class StringCurve {
 public:
  // Points into the tables, which must live as long.
  StringCurve(const ArrayWiring::String& wiring, const CellTables& tables,
              const std::vector<double>& photocurrents_A);

  // The regime at a current ≥ 0.
  StringRegime regime_at(double current_A) const;
  // Per substring, the current at which a clamping bypass diode begins to conduct; ∞ without one.
  std::vector<double> clamp_currents_A() const;
  // The largest photocurrent: V ≤ 0 from this current on.
  double largest_photocurrent_A() const { return largest_photocurrent_A_; }
  // The voltage at no current behind the blocking diode's drop: above it a clamping diode blocks.
  double open_circuit_V() const { return open_circuit_V_; }
  bool has_blocking_clamp() const { return blocking_.kind == Diode::Kind::clamp; }

  StringState make_state() const;
  void at_current(double current_A, const StringRegime& regime, StringState& state) const;
  // The current is looked for in [low_A, high_A], or below when the voltage is above
  // open_circuit_V(), from the state's own current. Slopes are those of a current at most a
  // fraction `tolerance` away; the current itself is exact to second order in that.
  void at_voltage(double voltage_V, const StringRegime& regime, double low_A, double high_A,
                  double tolerance, StringState& state) const;

  // Bounds on I(V) between two states; `high_i` at the higher current.
  SlopeRange conductance_range(const StringState& low_i, const StringState& high_i,
                               const StringRegime& regime) const;
  // Bounds on V(I).
  SlopeRange resistance_range(const StringState& low_i, const StringState& high_i,
                              const StringRegime& regime) const;

  // Terminal voltage and current of every cell at a string current, into arrays indexed as the
  // wiring's cells.
  void cells_at(double current_A, std::vector<double>& voltages_V,
                std::vector<double>& currents_A) const;

 private:
  // A Diode with n V_t and its reciprocal at hand.
  struct Junction {
    Diode::Kind kind = Diode::Kind::none;
    double drop_V = 0.0, saturation_A = 0.0, series_ohm = 0.0;
    double scale_V = 0.0, per_scale_1_V = 0.0;

    explicit Junction(const Diode& diode);
    // I(V) with the series resistance, from the junction's own conductance.
    double slope_S(double conductance_S) const;
    double curvature_A_V2(double conductance_S) const;
    SlopeRange range(double low_S, double high_S) const;
  };
  // Cells of a substring: first those in series, one after the other, then the rows of tied ones.
  struct Row {
    uint32_t first_cell, cells;
  };
  struct Substring {
    Junction bypass;
    uint32_t first_cell = 0, cells = 0;  // in series
    uint32_t first_row = 0, rows = 0;    // of tied cells
    double clamp_A = std::numeric_limits<double>::infinity();
    double open_circuit_V = 0.0;  // of the rows
  };

  void add_substring(const ArrayWiring::Substring& wiring, const CellTables& tables,
                     const std::vector<double>& photocurrents_A);
  ElementPoint rows_at(const Substring& substring, double current_A, StringState& state) const;
  ElementPoint bypassed_at(uint32_t index, double current_A, StringState& state) const;
  ElementPoint substrings_at(double current_A, const StringRegime& regime,
                             StringState& state) const;
  void reverse_at_voltage(double voltage_V, const StringRegime& regime, StringState& state) const;
  double clamp_current_A(const Substring& substring, StringState& state) const;
  double largest_A(const Substring& substring) const;
  SlopeRange substring_range(uint32_t index, const StringState& low_i,
                             const StringState& high_i) const;

  std::span<const LitCell> lit(const Row& row) const {
    return std::span(cells_).subspan(row.first_cell, row.cells);
  }
  std::span<const Row> rows_of(const Substring& substring) const {
    return std::span(rows_).subspan(substring.first_row, substring.rows);
  }

  std::vector<LitCell> cells_;
  std::vector<std::vector<int>> wired_;  // the wiring's cells behind each of cells_
  std::vector<Row> rows_;
  std::vector<Substring> substrings_;
  Junction blocking_;
  double largest_photocurrent_A_ = 0.0;
  double open_circuit_V_ = 0.0;
};

}  // namespace photorque
