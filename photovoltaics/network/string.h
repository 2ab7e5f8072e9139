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
  // A part at its current, where the next solution starts; of a junction beside it the voltage
  // without R_s and the conductance.
  struct Part {
    double junction_V = -std::numeric_limits<double>::infinity();
    double junction_S = 0.0;
    double current_A = 0.0;
    ElementPoint at;
  };
  std::vector<Part> parts;
  double blocking_ohm = 0.0;  // of the blocking junction, without R_s

  Slopes slopes() const { return {slope_ohm, curvature_V_A2, third_V_A3}; }
};

// Which ideal diodes conduct. Over a piece of the curve on which this does not change, the string
// is a smooth element.
struct StringRegime {
  std::vector<char> clamped;  // per part: its ideal bypass diode carries the current
  bool blocked = false;       // the blocking diode carries none

  bool operator==(const StringRegime&) const = default;
};

// Derivatives of V and of its slope dV/dI with respect to the photocurrent of a cell, at fixed
// current.
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
  bool is_shorted() const { return substrings_ == 0; }

  // The regime at a current ≥ 0.
  StringRegime regime_at(double current_A) const;
  // Per part, the string's current at which an ideal bypass diode beside it starts to conduct; ∞
  // without one, and where the current never gets there.
  std::vector<double> clamp_currents_A() const;
  // The largest photocurrent: V ≤ 0 from this current on.
  double largest_photocurrent_A() const { return largest_photocurrent_A_; }
  // Start of a search for a current when nothing is known.
  double first_guess_A() const;
  // The voltage at no current behind the blocking diode's drop: above it a clamping diode blocks.
  double open_circuit_V() const { return open_circuit_V_; }
  // Lower bound of V at any current; −∞ unless clamping diodes bypass all cells.
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

  // Change of the voltage with each cell whose substring is not clamped. The cells of `state` must
  // have been evaluated within a small tolerance.
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
  // Cells of one law in series, filled up with cells of no copies to a multiple of
  // DiodeVoltageLaw::lanes.
  struct Run {
    const DiodeVoltageLaw* law;
    double series_ohm, offset_V;  // of all cells
    uint32_t first_cell, cells, filled_cells;
  };
  static constexpr uint32_t nothing = std::numeric_limits<uint32_t>::max();
  static constexpr double unlimited = std::numeric_limits<double>::infinity();
  // Runs of cells and parts in series, or tied cells and parts in parallel, with a bypass diode
  // beside all of them or none. The substrings come first; a part stands before those inside it.
  struct Part {
    DiodeJunction bypass;
    bool in_parallel = false;
    uint32_t parent = nothing;
    uint32_t first_run = 0, runs = 0;    // in series
    uint32_t first_cell = 0, cells = 0;  // tied
    uint32_t first_part = 0, parts = 0;  // of inner_
    double largest_A = 0.0;              // V ≤ 0 from this current on
    double light_A = 0.0;                // about the short-circuit current
    double open_circuit_V = 0.0;         // without the bypass diode
    // Currents of this part: where its ideal diode starts to conduct; about where its junction
    // does.
    double own_clamp_A = unlimited, turn_on_A = unlimited;
    double clamp_A = unlimited;  // of the string, where this part's ideal diode starts to conduct
    // Which voltage no current goes below, and the current that gets there.
    double lowest_V = -unlimited, lowest_A = unlimited;
    bool has_clamps = false;  // inside it
  };
  struct Source {
    const CellTables& tables;
    const std::vector<double>& photocurrents_A;
  };

  bool close(double voltage_V) const { return std::abs(voltage_V) <= close_V_; }
  void reserve(const ArrayWiring::String& wiring);
  void add_cell(int cell, const Source& source);
  void add_series(std::vector<int> cells, const Source& source);
  void fill_part(uint32_t index, const std::vector<CellGroup>& members, const Source& source);
  void prepare_part(uint32_t index, StringState& state);
  void find_clamp(uint32_t index, StringState& state);

  // A part at its current, without and with the diode beside it. Without a regime every ideal diode
  // conducts where the voltage asks for it.
  ElementPoint inside_at(uint32_t index, double current_A, const StringRegime* regime,
                         double tolerance, StringState& state) const;
  ElementPoint part_at(uint32_t index, double current_A, const StringRegime* regime,
                       double tolerance, StringState& state) const;
  ElementPoint bypassed_at(uint32_t index, double current_A, const StringRegime* regime,
                           double tolerance, StringState& state) const;
  ElementPoint tied_at(uint32_t index, double current_A, const StringRegime* regime,
                       StringState& state) const;
  std::optional<ElementPoint> tied_together_at(uint32_t index, double current_A,
                                               const StringRegime* regime,
                                               StringState& state) const;
  ElementPoint tied_nested_at(uint32_t index, double current_A, const StringRegime* regime,
                              StringState& state) const;
  // Current of all cells and parts in a part at a voltage, except those of `but`.
  double tied_A(uint32_t index, double voltage_V, const StringRegime* regime, uint32_t but,
                Slopes* slopes, StringState& state) const;
  // The part in parallel whose diodes hold the voltage of all; `nothing` where none does.
  uint32_t clamping_part(uint32_t index, const StringRegime& regime) const;
  bool is_held(uint32_t index, const StringRegime& regime) const;
  // The current of a part at a voltage.
  double part_A(uint32_t index, double voltage_V, const StringRegime* regime,
                StringState& state) const;
  static double bypass_guess_V(const Part& part, const StringState::Part& last, double current_A);
  ElementPoint substrings_at(double current_A, const StringRegime& regime, double tolerance,
                             StringState& state) const;
  // At a voltage from 0 to open circuit of a string that is one substring beside a junction: the
  // remainder of the voltage at a current through its cells, whose point goes to `rows`; and the
  // whole.
  FunctionAt beside_junction(double rows_A, double voltage_V, const StringRegime& regime,
                             ElementPoint& rows, StringState& state) const;
  void beside_junction_at_voltage(double voltage_V, const StringRegime& regime, double low_A,
                                  double high_A, double tolerance, StringState& state) const;
  double blocking_drop_V(double current_A) const;
  void add_blocking(StringState& state) const;
  void reverse_at_voltage(double voltage_V, const StringRegime& regime, StringState& state) const;
  // At which a part without its diode has the voltage −drop_V.
  double inside_A(uint32_t index, double drop_V, StringState& state) const;
  SlopeRange part_range(uint32_t index, const StringState& low_i, const StringState& high_i,
                        const StringRegime& regime) const;
  // Derivatives of a part with respect to the photocurrents of its cells, and its slopes.
  struct PartMotion {
    std::vector<VoltageMotion> moved;  // cells of this string
    double slope_ohm = 0.0, curvature_V_A2 = 0.0;
  };
  PartMotion motion_of(uint32_t index, const StringState& state, const StringRegime& regime) const;
  void part_cells_at(uint32_t index, double current_A, StringState& state,
                     std::vector<double>& voltages_V, std::vector<double>& currents_A) const;

  std::span<const LitCell> tied_cells(const Part& part) const {
    return std::span(cells_).subspan(part.first_cell, part.cells);
  }
  std::span<const uint32_t> inner(const Part& part) const {
    return std::span(inner_).subspan(part.first_part, part.parts);
  }
  std::span<const Run> runs_of(const Part& part) const {
    return std::span(runs_).subspan(part.first_run, part.runs);
  }
  std::span<const int> wired_to(uint32_t cell) const {
    const uint32_t first = first_wired_[cell];
    const size_t end = cell + 1 < first_wired_.size() ? first_wired_[cell + 1] : wired_.size();
    return std::span(wired_).subspan(first, end - first);
  }
  std::vector<LitCell> cells_;
  std::vector<double> photocurrents_A_, copies_;  // of cells_, side by side for vector registers
  std::vector<int> wired_;  // the wiring's cells behind each of cells_, one after the other
  std::vector<uint32_t> first_wired_;  // of each of cells_
  std::vector<Run> runs_;
  std::vector<Part> parts_;
  std::vector<uint32_t> inner_;  // the parts in each part
  uint32_t substrings_ = 0;
  DiodeJunction blocking_;
  double cell_offset_V_ = 0.0;
  double close_V_ = std::numeric_limits<double>::infinity();
  double largest_photocurrent_A_ = 0.0;
  double open_circuit_V_ = 0.0;
};

}  // namespace photorque
