// One cell of a header: the words of its name, and its unit.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace photorque {

struct HeaderUnit {
  // Suffix in names of channels ("deg_s"); empty: channels cannot have this unit.
  std::string suffix;
  // "time", "angle", "angular rate", "frequency" (Hz), "per second" (1/s: radians or revolutions),
  // "length", "speed", "acceleration", "angular acceleration", "magnetic field", "voltage",
  // "current", "power", "resistance", "illuminance".
  std::string dimension;
};

// A unit in symbols or in words of English, German, French, Spanish, Italian or Portuguese:
// "rad/s", "rad s⁻¹", "°", "Grad pro Sekunde", "U/min", "min⁻¹", "tr/min". Nothing if unknown.
std::optional<HeaderUnit> unit_written(std::string_view text);

struct HeaderCell {
  // Lower-case groups of letters or digits without accents, Greek letters by their names:
  // "gyroADC[0]" → "gyro", "adc", "0"; "Ángulo θ" → "angulo", "theta".
  std::vector<std::string> words;
  std::optional<HeaderUnit> unit;
  std::string unit_text;         // as written; if `unit` is empty, an unknown unit
  bool is_bare_unit = false;     // the cell contains a unit only
  bool is_between_bars = false;  // "|omega|"
  // A unit of one letter after a blank or an underscore, which may be a subscript: "theta_s".
  bool may_be_subscript = false;
};

// The unit is in brackets ("Time (s)"), after a slash ("phi/rad", "n / 1/min"), or the last word
// ("speed_rpm", "angle in Grad"). Digits and x, y, z in brackets belong to the name, and so does
// the argument t of a function.
HeaderCell read_header_cell(const std::string& in_file);

// The words of a cell that has no unit.
std::vector<std::string> words_of_header(std::string_view text);

}  // namespace photorque
