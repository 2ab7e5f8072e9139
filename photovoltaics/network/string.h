// One string of an array in given light: V as an explicit function of I.
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

// A point of a string's curve, with the data for bounds between two points. Reused between
// evaluations to avoid allocations.
struct StringState : ElementPoint {  // slope_ohm is ∞ for a blocked string
  double current_A = 0.0;
  std::vector<JunctionState> cells;
  // A part at its current, from which the next solution starts; for a bypass junction in parallel
  // with it, the voltage without R_s and the conductance.
  struct Part {
    double junction_V = -std::numeric_limits<double>::infinity();
    double junction_S = 0.0;
    double current_A = 0.0;
    ElementPoint at;
  };
  std::vector<Part> parts;
  double blocking_ohm = 0.0;  // blocking junction, without R_s
};

// State of the ideal diodes. On a piece of the curve on which it is constant, the string is a
// smooth element.
struct StringRegime {
  std::vector<char> clamped;  // per part: its ideal bypass diode conducts
  bool blocked = false;       // the blocking diode does not conduct

  bool operator==(const StringRegime&) const = default;
};

// Derivatives of V and of its slope dV/dI with respect to the photocurrent of a cell, at fixed
// current.
struct VoltageMotion {
  size_t cell = 0;  // index in the wiring
  double voltage_ohm = 0.0, slope_V_A2 = 0.0;
};

class StringCurve {
 public:
  // Keeps pointers into the tables, which must outlive this. Adds `cell_offset_V` to the voltage of
  // every cell. A substring for which is_shorted(its place in the string) is true has no voltage.
  StringCurve(const ArrayWiring::String& wiring, const CellTables& tables,
              const std::vector<double>& photocurrents_A, double cell_offset_V,
              const std::function<bool(size_t)>& is_shorted);

  // Whether all substrings are shorted.
  bool is_shorted() const { return substrings_ == 0; }

  // The regime at a current ≥ 0.
  StringRegime regime_at(double current_A) const;
  // Per part, the string's current at which its ideal bypass diode starts to conduct; ∞ without
  // such a diode, or if no current reaches this point.
  std::vector<double> clamp_currents_A() const;
  // The largest photocurrent: V ≤ 0 from this current on.
  double largest_photocurrent_A() const { return largest_photocurrent_A_; }
  // Start of a search for a current without further knowledge.
  double first_guess_A() const;
  // The voltage at zero current, less the blocking diode's drop. Above it a clamping diode blocks.
  double open_circuit_V() const { return open_circuit_V_; }
  // Lower bound of V at any current; −∞ unless clamping diodes bypass all cells.
  double lowest_V() const;
  bool has_blocking_clamp() const { return blocking_.kind == Diode::Kind::clamp; }
  // Voltage interval over which a cell's curve hardly changes its form: a tenth of the smallest n
  // V_t.
  double close_V() const { return close_V_; }

  StringState make_state() const;
  // Computes the state at a current. Cells with a bypass junction in parallel are evaluated within
  // a fraction `tolerance` of its voltage. The voltage and its derivatives are exact to third order
  // in that.
  void at_current(double current_A, const StringRegime& regime, double tolerance,
                  StringState& state) const;
  // Computes the state at a voltage. The current is searched in [low_A, high_A], or below if the
  // voltage is above open_circuit_V(), starting from the current of `state`. Slopes are those at a
  // current at most a fraction `tolerance` away; the current itself is exact to second order in
  // that.
  void at_voltage(double voltage_V, const StringRegime& regime, double low_A, double high_A,
                  double tolerance, StringState& state) const;

  // Derivatives with respect to the photocurrent of each cell whose substring is not clamped. The
  // cells of `state` must have been evaluated with a small tolerance.
  std::vector<VoltageMotion> voltage_motions(const StringState& state,
                                             const StringRegime& regime) const;

  // Bounds on I(V) between two states; `high_i` has the higher current.
  SlopeRange conductance_range(const StringState& low_i, const StringState& high_i,
                               const StringRegime& regime) const;
  // Bounds on V(I) between two states.
  SlopeRange resistance_range(const StringState& low_i, const StringState& high_i,
                              const StringRegime& regime) const;

  // Terminal voltage and current of every cell at a string current, written to arrays with the
  // indices of the wiring.
  void cells_at(double current_A, std::vector<double>& voltages_V,
                std::vector<double>& currents_A) const;

 private:
  // Cells of one law in series, padded with cells of zero copies to a multiple of
  // DiodeVoltageLaw::lanes.
  struct Run {
    const DiodeVoltageLaw* law;
    double series_ohm, offset_V;  // total of all cells
    uint32_t first_cell, cells, filled_cells;
  };
  static constexpr uint32_t nothing = std::numeric_limits<uint32_t>::max();
  static constexpr double unlimited = std::numeric_limits<double>::infinity();
  // Runs of cells and parts in series, or cells and parts in parallel, with or without a bypass
  // diode in parallel with all of them. Substrings come first; a part precedes those inside it.
  struct Part {
    DiodeJunction bypass;
    bool in_parallel = false;
    uint32_t parent = nothing;
    uint32_t first_run = 0, runs = 0;    // if in series
    uint32_t first_cell = 0, cells = 0;  // if in parallel
    uint32_t first_part = 0, parts = 0;  // indices in inner_
    double largest_A = 0.0;              // V ≤ 0 from this current on
    double light_A = 0.0;                // about the short-circuit current
    double open_circuit_V = 0.0;         // without the bypass diode
    // Currents of this part: at which its ideal diode starts to conduct; at which its junction
    // approximately does.
    double own_clamp_A = unlimited, turn_on_A = unlimited;
    double clamp_A = unlimited;  // string current at which this part's ideal diode conducts
    // Lower bound of the voltage at any current, and the current at which it is reached.
    double lowest_V = -unlimited, lowest_A = unlimited;
    bool has_clamps = false;  // whether parts inside it have clamping diodes
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

  // A part at its current, without and with its bypass diode. Without a regime every ideal diode
  // conducts if the voltage requires it.
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
  // Current at a voltage of all cells and parts in a part, except those of part `but`.
  double tied_A(uint32_t index, double voltage_V, const StringRegime* regime, uint32_t but,
                Slopes* slopes, StringState& state) const;
  // The part in parallel whose diodes determine the common voltage; `nothing` if there is none.
  uint32_t clamping_part(uint32_t index, const StringRegime& regime) const;
  bool is_held(uint32_t index, const StringRegime& regime) const;
  // Current of a part at a voltage.
  double part_A(uint32_t index, double voltage_V, const StringRegime* regime,
                StringState& state) const;
  static double bypass_guess_V(const Part& part, const StringState::Part& last, double current_A);
  ElementPoint substrings_at(double current_A, const StringRegime& regime, double tolerance,
                             StringState& state) const;
  // For a string that is one substring with a bypass junction, at a voltage from 0 to open circuit:
  // the voltage that remains at a current through its cells, whose point is written to `rows`; and
  // the solution.
  FunctionAt beside_junction(double rows_A, double voltage_V, const StringRegime& regime,
                             ElementPoint& rows, StringState& state) const;
  void beside_junction_at_voltage(double voltage_V, const StringRegime& regime, double low_A,
                                  double high_A, double tolerance, StringState& state) const;
  double blocking_drop_V(double current_A) const;
  void add_blocking(StringState& state) const;
  void reverse_at_voltage(double voltage_V, const StringRegime& regime, StringState& state) const;
  // Current at which a part without its diode has the voltage −drop_V.
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
  std::vector<double> photocurrents_A_, copies_;  // one per element of cells_, for vector registers
  std::vector<int> wired_;  // the wiring's cells behind each of cells_, one after the other
  std::vector<uint32_t> first_wired_;  // first index in wired_ for each of cells_
  std::vector<Run> runs_;
  std::vector<Part> parts_;
  std::vector<uint32_t> inner_;  // the parts inside each part
  uint32_t substrings_ = 0;
  DiodeJunction blocking_;
  double cell_offset_V_ = 0.0;
  double close_V_ = std::numeric_limits<double>::infinity();
  double largest_photocurrent_A_ = 0.0;
  double open_circuit_V_ = 0.0;
};

}  // namespace photorque
