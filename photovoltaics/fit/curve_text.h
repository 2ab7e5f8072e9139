// Current-voltage curves as instruments and spreadsheets write them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "photovoltaics/fit/fit.h"

namespace photorque {

// Names of columns in a file by what they stand for: {"voltage_V", "U_mod"}, {"current_mA", "I2"}.
using CurveColumns = std::map<std::string, std::string>;

// One curve of a file, with the circumstances that its rows state: means over them.
struct MeasuredCurve {
  IvSweep sweep;
  std::optional<double> irradiance_W_m2, temperature_K;
  bool is_reversed = false;  // its currents were negative in light; they are positive here
  bool is_density = false;   // its currents are those of 1 cm²
  std::string stated;        // irradiance and temperature by the lines above the header, in words
  // Rows without a number: empty, "NaN", "OL", an instrument's overflow; and lines below the last
  // reading.
  size_t unread = 0;
};

// The curves of a text, which `file` names in messages.
//
// Cells are separated by tabs, semicolons, commas or blanks, the first of these that the header
// has; but between commas numbers may have a decimal comma. Lines before the header, and those that
// begin with #, state at most the irradiance and the temperature ("Irradiance: 1000 W/m2", "Cell
// Temp (C)",25.1). The header names a voltage ("voltage_V", "Voltage (V)", "Volts", "V", "U [mV]",
// "Spannung / V") and a current ("current_A", "Current (mA)", "Amps", "I", "J (mA/cm2)"), plain or
// with qualifiers ("Vmod", "I_meas", "SMU-1 Voltage"); a plain name comes before a qualified one,
// of two qualified ones the first counts. Or it is that of a source-measure unit's buffer
// ("Reading", "Unit", "Source Value"). It may name an irradiance ("irradiance_W_m2", "G (W/m2)"), a
// temperature with its unit ("temperature_K", "cell_temperature_K", "T (°C)"), a time, and a column
// "sweep" or "curve" that numbers the curves of one file apart. Voltages and currents without a
// unit are V and A; a row below the header or the cells may state the units. Currents that are
// negative in light are counted the other way round.
//
// InputError with the line where there is no such header, a unit is unknown, or a cell is neither a
// number nor a sign of a missing one.
std::vector<MeasuredCurve> curves_in(std::string_view text, const std::string& file,
                                     const CurveColumns& columns = {});

// Whether a line is such a header and all that it names belongs to a curve (power, time and numbers
// of points may stand beside), or names come from `columns`.
bool is_curve_header(std::string_view line, const CurveColumns& columns = {});

// The cells of such a header as they stand in the file, without quotation marks.
std::vector<std::string> curve_header_cells(std::string_view line);

// Points of a curve that are left out because no cell produces them.
struct CurveCleaning {
  size_t clipped = 0;  // points beyond open circuit where the meter shows no current
  double clipped_from_V = 0.0, clipped_A = 0.0;  // their first voltage and their usual current
  size_t spikes = 0;                             // single readings far from both neighbours
};

// Takes out of a sweep what the meter made: the tail beyond open circuit along which the current
// stays where it is (a source that blocks reverse current shows 0 or a small offset), and single
// spikes. Beyond open circuit the current of a cell falls the more steeply the higher the voltage;
// a tail is points at the highest voltages whose currents lie within 3 % of zero and span less than
// a quarter of what the steepest slope before them makes over their voltages.
CurveCleaning clean_curve(IvSweep& sweep);

// Readings of the flat part of a curve, below 0.6 of its highest voltage, that were taken out
// because the light was another one.
struct UnsteadyLight {
  size_t readings = 0;
  double from_V = 0.0, to_V = 0.0;
  double largest = 0.0;  // departure of the current, as a fraction of the largest current
};

// Takes runs of three and more readings out of a sweep that lie off the falling line of most
// others, by three times `noise` (a fraction of the current) and 1 % somewhere, where the current
// rises with the voltage by half of that: a cell's current falls under steady light. A step down,
// as of a shadow on a substring, stays.
UnsteadyLight take_unsteady_light(IvSweep& sweep, double noise);

}  // namespace photorque
