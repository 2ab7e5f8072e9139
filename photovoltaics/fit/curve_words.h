// Words and units of the columns of current-voltage curves, in thirteen languages.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace photorque::curve_text {

enum Column { voltage, current, irradiance, temperature, curve_number, time, columns };

struct Unit {
  std::string_view name;
  double to_SI, offset;  // SI = (value + offset) · to_SI
};

// The unit of a column by its name in small letters; empty if it is unknown.
std::optional<Unit> unit_named(Column column, std::string_view name);

// "Voltage (mV)" is a voltage in mV; "mA" a current; "V_meas", "Imod" and "SMU-1 Voltage" are
// qualified names.
struct Named {
  Column column = columns;
  std::optional<Unit> unit;
  std::string unknown_unit;
  enum Match { plain, qualified, set_value, by_unit } match = plain;  // the first has priority
};

Named named(std::string_view header_cell);

// A voltage or current of an unknown name by its unit in brackets at the end or after / or _:
// "Ewe/V", "Forward Scan (mA)". Single points ("Voc (V)"), errors, limits and dark currents are
// excluded.
Named named_by_unit(std::string_view header_cell);

// Whether a name is that of a current density, such as "J" or its word in another language.
bool names_density(std::string_view header_cell);

}  // namespace photorque::curve_text
