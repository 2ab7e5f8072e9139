// Wiring of the cells of an array.
#pragma once

#include <utility>
#include <vector>

namespace photorque {

// A diode in parallel with a substring (bypass) or in series with a string (blocking).
struct Diode {
  enum class Kind {
    none,
    clamp,     // no reverse current, exactly drop_V in forward direction
    junction,  // V = n V_t ln(1 + I/I_s) + I R_s
  };
  Kind kind = Kind::none;
  double drop_V = 0.5;         // clamp: ≥ 0; > 0 for a bypass
  double saturation_A = 1e-6;  // junction: I_s > 0
  double ideality = 1.05;      // junction: n > 0
  double series_ohm = 5e-3;    // junction: R_s ≥ 0
  double temperature_K = 298.15;
};

// A cell, or parts joined in series or in parallel, to any depth. Joined parts may have a bypass
// diode in parallel.
struct CellGroup {
  enum class Join { cell, series, parallel };
  Join join = Join::cell;
  int cell = -1;  // index, if it is a cell
  std::vector<CellGroup> parts;
  Diode bypass;

  CellGroup(int index) : cell(index) {}
  // Cells in parallel; a single cell is not a group.
  CellGroup(const std::vector<int>& tied) : join(Join::parallel) {
    if (tied.size() == 1) {
      *this = CellGroup(tied[0]);
    } else {
      parts.assign(tied.begin(), tied.end());
    }
  }
  CellGroup(Join how, std::vector<CellGroup> joined, const Diode& beside = {})
      : join(how), parts(std::move(joined)), bypass(beside) {}

  bool is_cell() const { return join == Join::cell; }
  template <class Function>
  void for_each_cell(const Function& f) const {
    if (is_cell()) f(cell);
    for (const CellGroup& part : parts) part.for_each_cell(f);
  }
};

// An array is strings in parallel. A string is substrings in series with one blocking diode. A
// substring is cells and groups of cells in series, with one bypass diode in parallel. Cells are
// identified by their index; each occurs once.
struct ArrayWiring {
  struct Substring {
    std::vector<CellGroup> rows;
    Diode bypass;
  };
  struct String {
    std::vector<Substring> substrings;
    Diode blocking;

    template <class Function>
    void for_each_cell(const Function& f) const {
      for (const Substring& substring : substrings) {
        for (const CellGroup& row : substring.rows) row.for_each_cell(f);
      }
    }
  };
  std::vector<String> strings;
  // All cells, string by string.
  std::vector<int> cells() const {
    std::vector<int> all;
    for (const String& string : strings) {
      string.for_each_cell([&](int cell) { all.push_back(cell); });
    }
    return all;
  }
};

// An array of one circuit. Its parallel branches are the strings, each with the blocking diode; the
// parts in series in a string are its substrings.
ArrayWiring wiring_of(const CellGroup& circuit, const Diode& blocking);

// Changes to a wired array.
struct ArrayChanges {
  double series_ohm = 0.0;     // ≥ 0, in series with the whole array
  double cell_offset_V = 0.0;  // added to the voltage of every cell
  // One element per string, and one per substring over all strings; may be empty.
  std::vector<bool> string_open;     // carries no current
  std::vector<bool> bypass_shorted;  // its cells give no voltage
};

}  // namespace photorque
