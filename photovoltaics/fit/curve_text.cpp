#include "photovoltaics/fit/curve_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/errors.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "photovoltaics/fit/curve_words.h"

namespace photorque {
namespace curve_text {
namespace {

std::vector<std::string_view> header_cells(std::string_view line, char separator) {
  return separator == ' ' ? names_between_blanks(line) : cells_of(line, separator);
}

// Marks of a missing reading, also those of SCPI instruments for overflow and no number.
bool is_missing(std::string_view cell, char separator) {
  constexpr std::string_view marks = "nan,na,n/a,inf,+inf,-inf,ol,-ol,overload,--,-,null";
  if (cell.empty() || is_listed(lower_case(cell), marks)) return true;
  const auto value = number_of_cell(cell, separator);
  return value && std::abs(*value) > 1e30;
}

// A further column of a quantity.
struct Further {
  size_t place;
  Unit unit;
};

struct Header {
  char separator = ',';
  std::array<std::optional<size_t>, columns> place;
  std::array<Unit, columns> unit;
  std::array<bool, columns> has_unit{};
  std::array<std::string, columns> title;  // title as written
  // Columns beside the first one that only their units name.
  std::array<std::vector<Further>, columns> further;
  size_t cells = 0;
  bool is_of_instrument = false;  // found by instrument_header()
};

// The buffer of a source-measure unit (Keithley 2450): "Reading" and "Source Value" or "Value" with
// columns of their units, which the rows state.
std::optional<Header> instrument_header(Header header, const std::vector<std::string_view>& cells) {
  std::optional<size_t> reading, source;
  for (size_t i = 0; i < cells.size(); ++i) {
    const std::string name = lower_case(cells[i]);
    if (!reading && name == "reading") reading = i;
    if (!source && (name == "source value" || name == "value" || name == "source")) source = i;
  }
  if (!reading || !source) return std::nullopt;
  header.is_of_instrument = true;
  header.place[voltage] = source;
  header.place[current] = reading;
  header.title[voltage] = cells[*source];
  header.title[current] = cells[*reading];
  return header;
}

// The columns of a header line; `by_unit`: also of unknown names with a known unit.
std::optional<Header> header_of(std::string_view line, const InputLocation& where,
                                const CurveColumns& columns_named, bool by_unit) {
  Header header;
  header.separator = separator_of(line);
  header.unit.fill({"", 1.0, 0.0});
  const std::vector<std::string_view> cells = header_cells(line, header.separator);
  header.cells = cells.size();
  std::array<Named::Match, columns> match{};
  for (size_t i = 0; i < cells.size(); ++i) {
    const std::string_view known = name_of_column(cells[i], columns_named);
    Named name = named(known);
    if (name.column == columns && by_unit) name = named_by_unit(known);
    if (name.column == columns) continue;
    const bool needed = name.column == voltage || name.column == current;
    if (!name.unknown_unit.empty()) {
      if (!needed || name.match != Named::plain) continue;
      throw InputError(where, std::string(cells[i]), "the unit " + name.unknown_unit,
                       name.column == voltage ? "V or mV" : "A, mA, µA or mA/cm²");
    }
    std::vector<Further>& further = header.further[name.column];
    if (header.place[name.column]) {
      // A plain name has priority over a qualified one, and the first of two qualified ones over
      // the second.
      if (!needed || name.match > match[name.column]) continue;
      const bool is_same = name.match == match[name.column];
      if (is_same && name.match == Named::by_unit) further.push_back({i, *name.unit});
      if (is_same && name.match != Named::plain) continue;
      if (is_same) {
        throw InputError(where, std::string(cells[i]), "a second column of this quantity",
                         "one voltage and one current; one curve a file, or a column \"curve\"");
      }
    }
    further.clear();
    match[name.column] = name.match;
    header.place[name.column] = i;
    header.has_unit[name.column] = name.unit.has_value();
    header.title[name.column] = cells[i];
    header.unit[name.column] = name.unit.value_or(Unit{"", 1.0, 0.0});
  }
  if (!header.place[voltage] || !header.place[current]) return instrument_header(header, cells);
  return header;
}

// Whether all columns of a header belong to a curve. A log of a motor, for example, has further
// columns.
bool is_of_curve(std::string_view line, const Header& header, bool by_unit) {
  if (header.is_of_instrument) return lower_case(line).find("unit") != line.npos;
  constexpr std::string_view beside =
      "power,p,leistung,puissance,potencia,potenza,time,zeit,temps,tiempo,tempo,date,index,point,"
      "no,nr,number,id,rep,/,in,watts,watt,run,direction,status,stat,res";
  for (const std::string_view cell : header_cells(line, header.separator)) {
    std::string text = lower_case(cell);
    // A dark curve beside the one in light is left out.
    if (text.empty() || text.find("dark") != text.npos || named(text).column != columns) continue;
    if (by_unit && named_by_unit(text).column != columns) continue;
    std::ranges::replace(text, '_', ' ');
    text = text.substr(0, text.find_first_of(" ([/.", 1));
    if (text.starts_with('[') || text.starts_with('(')) continue;
    if (!is_listed(text, beside)) return false;
  }
  return true;
}

// Rate of the voltage at each reading: per second or, without times, per reading. Differences over
// a few readings reduce the scatter of single voltages.
void find_rates(IvSweep& sweep, std::vector<double> time_s) {
  const size_t readings = sweep.voltage_V.size();
  sweep.is_timed = time_s.size() == readings && std::ranges::is_sorted(time_s) && readings > 1 &&
                   time_s.front() < time_s.back();
  const size_t reach = std::max<size_t>(1, readings / 50);
  for (size_t i = 0; i < readings; ++i) {
    const size_t low = i - std::min(i, reach), high = std::min(readings - 1, i + reach);
    double passed = static_cast<double>(high - low);
    if (sweep.is_timed) passed = time_s[high] - time_s[low];
    const double rise_V = sweep.voltage_V[high] - sweep.voltage_V[low];
    sweep.rate_V_s.push_back(passed > 0.0 ? rise_V / passed : 0.0);
  }
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& file, const CurveColumns& columns_named)
      : text_(text), lines_(text, file), file_(file), columns_named_(columns_named) {}

  CurveColumns named_columns() {
    if (!find_header() || header_.is_of_instrument) return {};
    CurveColumns named;
    for (const Column column : {voltage, current}) {
      const Unit& unit = header_.unit[column];
      const bool is_density = unit.name.find('/') != unit.name.npos,
                 needs_size = !header_.has_unit[column] && names_density(header_.title[column]);
      const std::string prefix = unit.to_SI == 1e-3   ? "m"
                                 : unit.to_SI == 1e-6 ? "u"
                                                      : "",
                        area = !is_density          ? ""
                               : unit.to_SI == 1e-4 ? "_m2"
                                                    : "_cm2";
      named[column == voltage ? "voltage_" + prefix + "V"
            : needs_size      ? "current"
                              : "current_" + prefix + "A" + area] = header_.title[column];
    }
    return named;
  }

  std::vector<MeasuredCurve> read() {
    if (!find_header()) throw without_header();
    bool is_first = true;
    for (std::string_view line; lines_.next(line); is_first = false) {
      if (is_first) header_.separator = separator_of_rows(line);
      const std::vector<std::string_view> cells = cells_of(line, header_.separator);
      if (is_first && states_units(cells)) continue;
      if (is_first && header_.is_of_instrument) assign_instrument(cells);
      read_row(cells, 0.0);
      if (header_.further[current].empty()) continue;
      const Header first = header_;
      for (size_t k = 0; k < first.further[current].size(); ++k) {
        header_.place[current] = first.further[current][k].place;
        header_.unit[current] = first.further[current][k].unit;
        read_row(cells, static_cast<double>(k + 1));
      }
      header_ = first;
    }
    if (header_.place[temperature] && !header_.has_unit[temperature]) {
      throw InputError({file_}, "temperature", "a column without a unit",
                       "its unit in the header, K or °C");
    }
    std::vector<MeasuredCurve> all;
    for (const double number : order_) add_curves(rows_.at(number), all);
    if (all.empty()) throw InputError(lines_.where(), "", "no readings", "rows of numbers");
    all.back().unread += lines_after_;
    return all;
  }

 private:
  // The readings with one curve number; NaN where a row states no irradiance, temperature or time.
  struct Rows {
    std::array<std::vector<double>, columns> of;
    size_t unread = 0;
  };

  bool find_header() {
    std::string_view line;
    for (const bool by_unit : {false, true}) {
      lines_ = DataLines(text_, file_);
      while (lines_.next(line)) {
        if (const auto header = header_of(line, lines_.where(), columns_named_, by_unit)) {
          header_ = *header;
          refuse_ambiguous(line);
          read_conditions(line);
          return true;
        }
      }
    }
    return false;
  }

  InputError without_header() const {
    DataLines lines(text_, file_);
    std::string_view first;
    lines.next(first);
    const bool is_dark = lower_case(first).find("dark") != std::string::npos;
    return {{file_, 1},
            "",
            first.empty() ? "nothing" : in_quotes(first.substr(0, 60)),
            is_dark ? "a header that names the voltage and the current of a device in light"
                    : "a header that names a voltage and a current: add the line "
                      "voltage_V,current_A above the numbers"};
  }

  // Throws InputError for several columns that could be the voltage, or several currents beside a
  // column of curve numbers.
  void refuse_ambiguous(std::string_view line) const {
    for (const Column column : {voltage, current}) {
      const std::vector<Further>& further = header_.further[column];
      if (further.empty() || (column == current && !header_.place[curve_number])) continue;
      std::string names = in_quotes(header_.title[column]);
      for (const Further& one : further) {
        names += ", " + in_quotes(header_cells(line, header_.separator)[one.place]);
      }
      const bool is_voltage = column == voltage;
      throw InputError(lines_.where(), is_voltage ? "voltage" : "current", names,
                       std::string("one ") + (is_voltage ? "voltage" : "current") +
                           ": rename that column to " + (is_voltage ? "voltage_V" : "current_A") +
                           " (or with its unit, _m" + (is_voltage ? "V)" : "A)"));
    }
  }

  // Irradiance and temperature of the cells in the lines above `header`: "Irradiance: 1000 W/m2",
  // "Cell Temp (C)",25.1. A temperature needs its unit.
  void read_conditions(std::string_view header) {
    for (std::string_view line : lines_of(text_)) {
      if (line.data() + line.size() >= header.data()) return;
      line = line.substr(std::min(line.size(), line.find_first_not_of("#%/ \t\"")));
      const size_t end = line.find_first_of(":=;,\t");
      if (end == line.npos) continue;
      const Named name = named(unquoted(line.substr(0, end)));
      if (name.column != irradiance && name.column != temperature) continue;
      std::string rest(unquoted(line.substr(end + 1)));
      std::ranges::replace(rest, '\t', ' ');
      std::ranges::replace(rest, ';', ' ');
      if (line[end] != ',') std::ranges::replace(rest, ',', '.');
      const std::vector<std::string_view> words = words_of(rest, " ,\"()[]");
      if (words.empty()) continue;
      const auto number = number_in(words[0]);
      std::optional<Unit> unit = name.unit;
      if (words.size() > 1 && !unit) unit = unit_named(name.column, lower_case(words[1]));
      if (!unit && name.column == irradiance && words.size() == 1) unit = Unit{"", 1.0, 0.0};
      if (number && !unit) without_unit_ = line;
      if (!number || !unit) continue;
      stated_[name.column] = (*number + unit->offset) * unit->to_SI;
    }
  }

  // The separator of the first row, which may differ from that of a header that was added by hand.
  char separator_of_rows(std::string_view row) const {
    const size_t own = cells_of(row, header_.separator).size();
    for (const char other : {'\t', ';', ' '}) {
      const size_t cells = cells_of(row, other).size();
      if (own < header_.cells ? cells >= header_.cells
                              : own > header_.cells && cells == header_.cells) {
        return other;
      }
    }
    return header_.separator;
  }

  // Determines which of reading and source is the voltage, and their units, from the first row.
  void assign_instrument(const std::vector<std::string_view>& cells) {
    const auto unit_after = [&](Column column) -> std::optional<Unit> {
      for (size_t i = *header_.place[column] + 1; i < cells.size(); ++i) {
        const std::string unit = lower_case(cells[i]);
        if (unit_named(column == voltage ? current : voltage, unit)) return std::nullopt;
        if (const auto found = unit_named(column, unit)) return found;
      }
      return std::nullopt;
    };
    if (!unit_after(current)) std::swap(header_.place[voltage], header_.place[current]);
    for (const Column column : {voltage, current}) {
      if (const auto unit = unit_after(column)) header_.unit[column] = *unit;
    }
  }

  // Whether a row below the header states units.
  bool states_units(const std::vector<std::string_view>& cells) {
    for (const Column column : {voltage, current}) {
      const size_t place = *header_.place[column];
      if (place >= cells.size() || number_of_cell(cells[place], header_.separator)) return false;
    }
    bool all = true;
    for (const Column column : {voltage, current, irradiance, temperature}) {
      if (!header_.place[column] || *header_.place[column] >= cells.size()) continue;
      std::string text = lower_case(cells[*header_.place[column]]);
      std::erase_if(text, [](char c) { return c == '(' || c == ')' || c == '[' || c == ']'; });
      const auto unit = unit_named(column, text);
      all = all && unit.has_value();
      if (!unit) continue;
      header_.unit[column] = *unit;
      header_.has_unit[column] = true;
    }
    return all;
  }

  std::optional<double> value(Column column, const std::vector<std::string_view>& cells) const {
    const size_t place = *header_.place[column];
    std::string_view text = place < cells.size() ? cells[place] : "";
    if (is_missing(text, header_.separator)) return std::nullopt;
    Unit unit = header_.unit[column];
    // A cell may contain its unit: "0.52 V".
    const size_t digits = text.find_last_of("0123456789.") + 1;
    if (digits > 0 && digits < text.size()) {
      const auto stated = unit_named(column, lower_case(trimmed(text.substr(digits))));
      if (stated) text = text.substr(0, digits);
      unit = stated.value_or(unit);
    }
    const auto number = number_of_cell(text, header_.separator);
    if (!number)
      throw InputError(lines_.where(), header_.title[column], in_quotes(text), "a number");
    return (*number + unit.offset) * unit.to_SI;
  }

  // Whether a row is below the readings ("End of data"): it has no voltage. If a reading follows
  // such a row, the row is an error.
  bool is_after_readings(const std::vector<std::string_view>& cells) {
    try {
      value(voltage, cells);
    } catch (const InputError& error) {
      if (order_.empty()) throw;
      if (!after_readings_) after_readings_ = error;
      ++lines_after_;
      return true;
    }
    if (after_readings_) throw *after_readings_;
    return false;
  }

  // Reads a row of the curve `further`, or of the one whose number it states.
  void read_row(const std::vector<std::string_view>& cells, double further) {
    // The cause may be decimal commas, which shift the following cells.
    if (header_.separator == ',' && header_.cells == 2 && cells.size() == 4) {
      throw InputError(lines_.where(), "", "a row of 4 cells",
                       "2, as in the header: separate decimal commas by semicolons");
    }
    if (is_after_readings(cells)) return;
    const double number =
        header_.place[curve_number] ? value(curve_number, cells).value_or(0.0) : further;
    const auto [found, is_new] = rows_.try_emplace(number);
    if (is_new) order_.push_back(number);
    Rows& rows = found->second;
    const auto v = value(voltage, cells), i = value(current, cells);
    if (!v || !i) {
      ++rows.unread;
      return;
    }
    rows.of[voltage].push_back(*v);
    rows.of[current].push_back(*i);
    for (const Column column : {irradiance, temperature}) {
      rows.of[column].push_back(header_.place[column] ? value(column, cells).value_or(NAN) : NAN);
    }
    // Times of day ("08:00") are ignored.
    std::optional<double> time_s;
    if (header_.place[time] && *header_.place[time] < cells.size()) {
      time_s = number_of_cell(cells[*header_.place[time]], header_.separator);
    }
    rows.of[time].push_back(time_s.value_or(NAN) * header_.unit[time].to_SI);
  }

  void add_curves(const Rows& rows, std::vector<MeasuredCurve>& all) const {
    // Curves without numbers may stand one below the other.
    std::vector<size_t> starts = {0};
    if (!header_.place[curve_number]) starts = starts_of_curves(rows.of[voltage]);
    for (size_t k = 0; k < starts.size(); ++k) {
      const auto from = static_cast<ptrdiff_t>(starts[k]);
      const auto to =
          static_cast<ptrdiff_t>(k + 1 < starts.size() ? starts[k + 1] : rows.of[voltage].size());
      std::array<std::vector<double>, columns> part;
      for (size_t c = 0; c < rows.of.size(); ++c) {
        if (!rows.of[c].empty()) part[c] = {rows.of[c].begin() + from, rows.of[c].begin() + to};
      }
      all.push_back(finished(std::move(part)));
      all.back().is_stacked = starts.size() > 1;
    }
    all.back().unread = rows.unread;
  }

  MeasuredCurve finished(std::array<std::vector<double>, columns> readings) const {
    MeasuredCurve curve;
    // The mean of the rows that state a value, otherwise that above the header.
    const auto mean = [&](Column column) -> std::optional<double> {
      double sum = 0.0, count = 0.0;
      for (const double one : readings[column]) {
        if (!std::isfinite(one)) continue;
        sum += one;
        count += 1.0;
      }
      if (count > 0.0) return sum / count;
      if (stated_[column]) {
        curve.stated += (curve.stated.empty() ? "" : ", ") + readable_number(*stated_[column], 5) +
                        (column == irradiance ? " W/m²" : " K");
      }
      return stated_[column];
    };
    curve.irradiance_W_m2 = mean(irradiance);
    curve.temperature_K = mean(temperature);
    curve.without_unit = without_unit_;
    curve.is_density = header_.unit[current].name.find('/') != std::string_view::npos;
    curve.sweep.voltage_V = std::move(readings[voltage]);
    curve.sweep.current_A = std::move(readings[current]);
    // Sunlight generates at most 0.07 A/cm² in one junction: larger densities without a unit are in
    // mA/cm².
    if (!header_.has_unit[current] && names_density(header_.title[current])) {
      constexpr double largest_A_cm2 = 0.5;
      curve.is_density = true;
      const bool is_milli = std::ranges::any_of(
          curve.sweep.current_A, [](double one) { return std::abs(one) > largest_A_cm2; });
      for (double& one : curve.sweep.current_A) one *= is_milli ? 1e-3 : 1.0;
    }
    curve.is_reversed = reverse_negative(curve.sweep);
    if (std::ranges::all_of(readings[irradiance], [](double one) { return std::isfinite(one); }) &&
        curve.irradiance_W_m2.value_or(0.0) > 0.0) {
      for (const double one : readings[irradiance]) {
        curve.sweep.light.push_back(one / *curve.irradiance_W_m2);
      }
      if (!curve.sweep.light.empty() &&
          std::ranges::min(curve.sweep.light) == std::ranges::max(curve.sweep.light)) {
        curve.sweep.light.clear();
      }
    }
    std::erase_if(readings[time], [](double one) { return !std::isfinite(one); });
    find_rates(curve.sweep, std::move(readings[time]));
    return curve;
  }

  std::string_view text_;
  DataLines lines_;
  std::string file_;
  CurveColumns columns_named_;
  Header header_;
  std::map<double, Rows> rows_;
  std::vector<double> order_;
  std::array<std::optional<double>, columns> stated_;  // above the header
  std::string without_unit_;                           // above the header
  std::optional<InputError> after_readings_;           // the first line without a voltage
  size_t lines_after_ = 0;
};

}  // namespace
}  // namespace curve_text

std::vector<size_t> starts_of_curves(const std::vector<double>& voltage_V) {
  constexpr size_t fewest = 6;  // readings of a curve
  // Fractions of the range of the voltages of a curve.
  constexpr double returns = 0.8, near = 0.2, steady = 0.1;
  std::vector<size_t> starts = {0};
  double low = NAN, high = NAN, rise = 0.0, fall = 0.0;  // `rise`, `fall`: largest steps
  for (size_t i = 0; i < voltage_V.size(); ++i) {
    const size_t first = starts.back();
    const double v = voltage_V[i], range = high - low,
                 step = i > first ? v - voltage_V[i - 1] : 0.0,
                 net = i > first ? voltage_V[i - 1] - voltage_V[first] : 0.0;
    if (i >= first + fewest && voltage_V.size() - i >= fewest && step * net < 0.0 &&
        std::min(std::abs(step), std::abs(net)) > returns * range &&
        (net > 0.0 ? fall : rise) <= steady * range && v > low - near * range &&
        v < high + near * range) {
      starts.push_back(i);
      low = high = NAN;
      rise = fall = 0.0;
    } else {
      rise = std::max(rise, step);
      fall = std::max(fall, -step);
    }
    low = std::fmin(low, v);
    high = std::fmax(high, v);
  }
  return starts;
}

std::vector<MeasuredCurve> curves_in(std::string_view text, const std::string& file,
                                     const CurveColumns& columns) {
  return curve_text::Reader(text, file, columns).read();
}

CurveColumns curve_columns_in(std::string_view text, const std::string& file) {
  return curve_text::Reader(text, file, {}).named_columns();
}

bool is_curve_header(std::string_view line, const CurveColumns& columns) {
  try {
    if (const auto header = curve_text::header_of(line, {}, columns, false)) {
      return !columns.empty() || curve_text::is_of_curve(line, *header, false);
    }
    const auto header = curve_text::header_of(line, {}, columns, true);
    return header && columns.empty() && !header->place[curve_text::time] &&
           curve_text::is_of_curve(line, *header, true);
  } catch (const InputError&) {
    return true;  // it names curve columns, but in a form that the reader rejects
  }
}

std::vector<std::string> curve_header_cells(std::string_view line) {
  const auto cells = curve_text::header_cells(line, separator_of(line));
  return {cells.begin(), cells.end()};
}

}  // namespace photorque
