// How the cells of an array are joined.
#pragma once

#include <vector>

namespace photorque {

// A diode beside a substring (bypass) or in a string (blocking).
struct Diode {
  enum class Kind {
    none,
    clamp,     // no current backwards, exactly drop_V forwards
    junction,  // V = n V_t ln(1 + I/I_s) + I R_s
  };
  Kind kind = Kind::none;
  double drop_V = 0.5;         // clamp: ≥ 0; > 0 for a bypass
  double saturation_A = 1e-6;  // junction: I_s > 0
  double ideality = 1.05;      // junction: n > 0
  double series_ohm = 5e-3;    // junction: R_s ≥ 0
  double temperature_K = 298.15;
};

// An array is strings in parallel; a string is substrings in series behind one blocking diode; a
// substring is rows in series beside one bypass diode; a row is cells tied in parallel (one cell
// where nothing is cross-tied). Cells are named by their index; each occurs once.
struct ArrayWiring {
  struct Substring {
    std::vector<std::vector<int>> rows;
    Diode bypass;
  };
  struct String {
    std::vector<Substring> substrings;
    Diode blocking;
  };
  std::vector<String> strings;
};

// What differs from an array as it is wired.
struct ArrayChanges {
  double series_ohm = 0.0;     // ≥ 0, in series with the whole array
  double cell_offset_V = 0.0;  // added to the voltage of every cell
  // By string, and by substring over all strings in turn; may be empty.
  std::vector<bool> string_open;     // carries no current
  std::vector<bool> bypass_shorted;  // its cells give no voltage
};

}  // namespace photorque
