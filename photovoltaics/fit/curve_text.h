// Current-voltage curves in the formats of instruments and spreadsheets.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "photovoltaics/fit/fit.h"

namespace photorque {

// Column names of a file by quantity: {"voltage_V", "U_mod"}, {"current_mA", "I2"}.
using CurveColumns = std::map<std::string, std::string>;

// One curve of a file, with the conditions that its rows state, as means over the rows.
struct MeasuredCurve {
  IvSweep sweep;
  std::optional<double> irradiance_W_m2, temperature_K;
  bool is_reversed = false;  // its currents were negative in light; they are positive here
  bool is_density = false;   // its currents are those of 1 cm²
  bool is_stacked = false;   // another curve stands above or below it in the same rows
  std::string stated;        // irradiance and temperature by the lines above the header, in words
  std::string without_unit;  // a line above the header with a temperature whose unit is missing
  // Rows without a number: empty, "NaN", "OL", an instrument's overflow; and lines below the last
  // reading.
  size_t unread = 0;
};

// The curves of a text; `file` is its name in messages.
//
// Cells are separated by tabs, semicolons, commas or blanks: the first of these that occurs in the
// header. Numbers may have a decimal comma unless commas separate the cells. Lines before the
// header, and those that begin with #, may state the irradiance and the temperature ("Irradiance:
// 1000 W/m2", "Cell Temp (C)",25.1). The header names a voltage ("voltage_V", "Voltage (V)",
// "Volts", "V", "U [mV]", "Spannung / V") and a current ("current_A", "Current (mA)", "Amps", "I",
// "J (mA/cm2)"), plain or with qualifiers ("Vmod", "I_meas", "SMU-1 Voltage"). A plain name has
// priority over a qualified one, and the first of two qualified ones over the second. The header of
// a source-measure unit's buffer ("Reading", "Unit", "Source Value") is also accepted. The header
// may name an irradiance ("irradiance_W_m2", "G (W/m2)"), a temperature with its unit
// ("temperature_K", "cell_temperature_K", "T (°C)"), a time, and a column "sweep" or "curve" that
// numbers the curves of one file; curves without numbers may stand one below the other. Voltages
// and currents without a unit are V and A, current densities A/cm², or mA/cm² above 0.5; a row
// below the header or the cells may state the units. Currents that are negative in light are
// reversed.
//
// Throws InputError with the line if there is no such header, a unit is unknown, or a cell is
// neither a number nor a mark of a missing one.
std::vector<MeasuredCurve> curves_in(std::string_view text, const std::string& file,
                                     const CurveColumns& columns = {});

// The readings at which curves begin that stand one below the other: the first one, and those to
// which the voltage returns in one step by more than 0.8 of its range after it went one way. Each
// curve has at least six readings.
std::vector<size_t> starts_of_curves(const std::vector<double>& voltage_V);

// Whether a line is such a header and all its columns belong to a curve (power, time and numbers of
// points are allowed), or it has names from `columns`.
bool is_curve_header(std::string_view line, const CurveColumns& columns = {});

// The columns of the voltage and the current that the header of a text names, also beside columns
// of other quantities: {"voltage_mV", "U"}, {"current_A", "I (A)"}; empty without such a header.
// Throws InputError for an unknown unit, and for several columns that could be the voltage.
CurveColumns curve_columns_in(std::string_view text, const std::string& file);

// The cells of such a header as written in the file, without quotation marks.
std::vector<std::string> curve_header_cells(std::string_view line);

// Reverses the currents of a curve whose current is counted into the device. Returns whether it
// did. A current at zero voltage below 1e-3 of the range of the currents is not one of light.
bool reverse_negative(IvSweep& sweep);

// Points of a curve that are left out because no cell produces them.
struct CurveCleaning {
  size_t clipped = 0;  // points beyond open circuit where the meter shows a constant current
  double clipped_from_V = 0.0, clipped_A = 0.0;  // their first voltage and their usual current
  size_t spikes = 0;                             // single readings far from both neighbours
  size_t dead = 0;           // readings without current below voltages at which a current flows
  std::vector<size_t> kept;  // indices of the other points
};

// Removes readings that are due to the meter: single spikes, dead readings (a current of 0 although
// it falls with the voltage and flows at higher voltages), and the tail beyond open circuit in
// which the current is constant (a source that blocks reverse current shows 0 or a small offset).
// Beyond open circuit the current of a cell falls more steeply at higher voltages. A tail consists
// of points at the highest voltages. Their currents are below 3 % of the largest one, also negative
// by any amount, and span less than a quarter of the fall that the steepest slope before them would
// cause. In the curve of a module
// with `dark_parts`, a tail with a current of at least 0 over more than 15 % of the voltage is
// kept: the curve of a module with a dark cell has one.
CurveCleaning clean_curve(IvSweep& sweep, bool dark_parts = false);

// Readings at the upper end of the meter's range that were removed, and their current.
struct RangeLimit {
  size_t readings = 0;
  double current_A = 0.0;
};

// Removes the readings that equal the largest current if at least three of them are adjacent, and
// the median of the next three is lower by ten steps in which the currents are written. A plateau
// due to rounding ends step by step in a curve of 20 readings or more; of fewer, nothing is
// removed.
RangeLimit take_range_limit(IvSweep& sweep);

// Readings of the flat part of a curve, below 0.6 of its highest voltage, that were removed because
// the light was different.
struct UnsteadyLight {
  size_t readings = 0;
  double from_V = 0.0, to_V = 0.0;
  double largest = 0.0;  // deviation of the current, as a fraction of the largest current
};

// Removes runs of three or more readings that deviate from the falling line of most other readings.
// They deviate by three times `noise` (a fraction of the current) and by 1 % at some reading, and
// the current rises with the voltage by half of that deviation: in steady light a cell's current
// falls. A step down, for example due to a shadow on a substring, is kept.
UnsteadyLight take_unsteady_light(IvSweep& sweep, double noise);

}  // namespace photorque
