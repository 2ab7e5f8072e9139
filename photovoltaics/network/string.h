// One string of an array under given light: V as an explicit function of I.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/numerics/root.h"
#include "photovoltaics/network/elements.h"
#include "photovoltaics/network/wiring.h"

namespace photorque {

using CellTables = std::vector<std::shared_ptr<const DiodeVoltageLaw>>;

// A string of cells of one law in series, with one bypass diode over all of them at most.
struct PlainString {
  const DiodeVoltageLaw* law = nullptr;
  std::span<const double> photocurrents_A, copies;  // filled up to DiodeVoltageLaw::lanes
  double series_ohm = 0.0;                          // of all cells
  const DiodeJunction* bypass = nullptr;
  const DiodeJunction* blocking = nullptr;
};

// A point of a string's curve, with what the bounds between two points need. Reused between
// evaluations to spare allocations.
struct StringState {
  double current_A = 0.0;
  double voltage_V = 0.0;
  double slope_ohm = 0.0;       // −dV/dI; ∞ for a blocked string
  double curvature_V_A2 = 0.0;  // d²V/dI²
  double third_V_A3 = 0.0;      // d³V/dI³
  std::vector<JunctionState> cells;
  // A junction beside a substring: its voltage without R_s, where the next solution starts, and its
  // conductance there; and the substring, at what current.
  struct Bypass {
    double junction_V = -std::numeric_limits<double>::infinity();
    double junction_S = 0.0;
    double current_A = 0.0;
    ElementPoint substring;
  };
  std::vector<Bypass> bypasses;
  double blocking_ohm = 0.0;  // of the blocking junction, without R_s

  Slopes slopes() const { return {slope_ohm, curvature_V_A2, third_V_A3}; }
};

// Which ideal diodes conduct. Over a piece of the curve on which this does not change, the string
// is a smooth element.
struct StringRegime {
  std::vector<char> clamped;  // per substring: its bypass carries the current
  bool blocked = false;       // the blocking diode carries none

  bool operator==(const StringRegime&) const = default;
};

// How V, and its slope dV/dI, move with the photocurrent of a cell at fixed current.
struct VoltageMotion {
  size_t cell = 0;  // of the wiring
  double voltage_ohm = 0.0, slope_V_A2 = 0.0;
};

class StringCurve {
 public:
  // Points into the tables, which must live as long. Adds `cell_offset_V` to the voltage of every
  // cell; a substring for which is_shorted(its place in the string) is true has no voltage.
  StringCurve(const ArrayWiring::String& wiring, const CellTables& tables,
              const std::vector<double>& photocurrents_A, double cell_offset_V,
              const std::function<bool(size_t)>& is_shorted);

  // Whether all substrings are shorted.
  bool is_shorted() const { return substrings_.empty(); }

  // The regime at a current ≥ 0.
  StringRegime regime_at(double current_A) const;
  // Per substring, the current at which a clamping bypass diode begins to conduct; ∞ without one.
  std::vector<double> clamp_currents_A() const;
  // The largest photocurrent: V ≤ 0 from this current on.
  double largest_photocurrent_A() const { return largest_photocurrent_A_; }
  // Where a search for a current may begin when nothing is known.
  double first_guess_A() const;
  // The voltage at no current behind the blocking diode's drop: above it a clamping diode blocks.
  double open_circuit_V() const { return open_circuit_V_; }
  // What V does not fall below at any current; −∞ unless clamping diodes bypass all cells.
  double lowest_V() const;
  bool has_blocking_clamp() const { return blocking_.kind == Diode::Kind::clamp; }
  // Nothing for other strings. Points into this.
  std::optional<PlainString> plain() const;
  // Over which a cell's curve keeps its shape: a tenth of the least n V_t.
  double close_V() const { return close_V_; }

  StringState make_state() const;
  // Cells behind a bypass junction are evaluated within a fraction `tolerance` of its voltage; the
  // voltage and its derivatives are exact to third order in that.
  void at_current(double current_A, const StringRegime& regime, double tolerance,
                  StringState& state) const;
  // The current is looked for in [low_A, high_A], or below when the voltage is above
  // open_circuit_V(), from the state's own current. Slopes are those of a current at most a
  // fraction `tolerance` away; the current itself is exact to second order in that.
  void at_voltage(double voltage_V, const StringRegime& regime, double low_A, double high_A,
                  double tolerance, StringState& state) const;

  // Of each cell whose substring is not clamped, from a state whose cells were evaluated within a
  // small tolerance.
  std::vector<VoltageMotion> voltage_motions(const StringState& state,
                                             const StringRegime& regime) const;

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
  // Cells of a substring: first those in series, in runs of one law, then the rows of tied ones.
  struct Row {
    uint32_t first_cell, cells;
  };
  // Filled up with cells of no copies to a multiple of DiodeVoltageLaw::lanes.
  struct Run {
    const DiodeVoltageLaw* law;
    double series_ohm, offset_V;  // of all cells
    uint32_t first_cell, cells, filled_cells;
  };
  struct Substring {
    DiodeJunction bypass;
    uint32_t first_run = 0, runs = 0;  // of cells in series
    uint32_t first_row = 0, rows = 0;  // of tied cells
    double clamp_A = std::numeric_limits<double>::infinity();
    double turn_on_A = std::numeric_limits<double>::infinity();  // of a junction, about
    double open_circuit_V = 0.0;                                 // of the rows
  };

  bool close(double voltage_V) const { return std::abs(voltage_V) <= close_V_; }
  void reserve(const ArrayWiring::String& wiring);
  void add_cell(int cell, const CellTables& tables, const std::vector<double>& photocurrents_A);
  void add_series(std::vector<int> cells, const CellTables& tables,
                  const std::vector<double>& photocurrents_A);
  void add_substring(const ArrayWiring::Substring& wiring, const CellTables& tables,
                     const std::vector<double>& photocurrents_A);
  ElementPoint rows_at(const Substring& substring, double current_A, StringState& state) const;
  static double bypass_guess_V(const Substring& substring, const StringState::Bypass& last,
                               double current_A);
  ElementPoint bypassed_at(uint32_t index, double current_A, double tolerance,
                           StringState& state) const;
  ElementPoint substrings_at(double current_A, const StringRegime& regime, double tolerance,
                             StringState& state) const;
  // At a voltage from 0 to open circuit of a string that is one substring beside a junction: what
  // is left of the voltage at a current through its cells, whose point goes to `rows`; and the
  // whole.
  FunctionAt beside_junction(double rows_A, double voltage_V, ElementPoint& rows,
                             StringState& state) const;
  void beside_junction_at_voltage(double voltage_V, double low_A, double high_A, double tolerance,
                                  StringState& state) const;
  double blocking_drop_V(double current_A) const;
  void add_blocking(StringState& state) const;
  void reverse_at_voltage(double voltage_V, const StringRegime& regime, StringState& state) const;
  // At which the rows have the voltage −drop_V.
  double rows_current_A(const Substring& substring, double drop_V, StringState& state) const;
  double largest_A(const Substring& substring) const;
  SlopeRange substring_range(uint32_t index, const StringState& low_i,
                             const StringState& high_i) const;

  std::span<const LitCell> lit(const Row& row) const {
    return std::span(cells_).subspan(row.first_cell, row.cells);
  }
  std::span<const int> wired_to(uint32_t cell) const {
    const uint32_t first = first_wired_[cell];
    const size_t end = cell + 1 < first_wired_.size() ? first_wired_[cell + 1] : wired_.size();
    return std::span(wired_).subspan(first, end - first);
  }
  std::span<const Row> rows_of(const Substring& substring) const {
    return std::span(rows_).subspan(substring.first_row, substring.rows);
  }
  std::span<const Run> runs_of(const Substring& substring) const {
    return std::span(runs_).subspan(substring.first_run, substring.runs);
  }

  std::vector<LitCell> cells_;
  std::vector<double> photocurrents_A_, copies_;  // of cells_, side by side for vector registers
  std::vector<int> wired_;  // the wiring's cells behind each of cells_, one after the other
  std::vector<uint32_t> first_wired_;  // of each of cells_
  std::vector<Run> runs_;
  std::vector<Row> rows_;
  std::vector<Substring> substrings_;
  DiodeJunction blocking_;
  double cell_offset_V_ = 0.0;
  double close_V_ = std::numeric_limits<double>::infinity();
  double largest_photocurrent_A_ = 0.0;
  double open_circuit_V_ = 0.0;
};

}  // namespace photorque
