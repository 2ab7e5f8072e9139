#include "photovoltaics/fit/curve_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <span>

#include "core/errors.h"
#include "core/text/format.h"
#include "core/text/parse.h"

namespace photorque {
namespace curve_text {
namespace {

constexpr double zero_celsius_K = 273.15;

enum Column { voltage, current, irradiance, temperature, curve_number, time, columns };

struct Unit {
  std::string_view name;
  double to_SI, offset;  // SI = (value + offset) · to_SI
};

std::span<const Unit> units_of(Column column) {
  static constexpr std::array<Unit, 4> volts = {
      {{"v", 1.0, 0.0}, {"mv", 1e-3, 0.0}, {"volts", 1.0, 0.0}, {"volt", 1.0, 0.0}}};
  // A density is the current of 1 cm².
  static constexpr std::array<Unit, 12> amperes = {{{"a", 1.0, 0.0},
                                                    {"ma", 1e-3, 0.0},
                                                    {"ua", 1e-6, 0.0},
                                                    {"µa", 1e-6, 0.0},
                                                    {"μa", 1e-6, 0.0},
                                                    {"amps", 1.0, 0.0},
                                                    {"amp", 1.0, 0.0},
                                                    {"ma/cm2", 1e-3, 0.0},
                                                    {"ma/cm^2", 1e-3, 0.0},
                                                    {"ma/cm²", 1e-3, 0.0},
                                                    {"a/cm2", 1.0, 0.0},
                                                    {"a/m2", 1e-4, 0.0}}};
  static constexpr std::array<Unit, 5> seconds = {{{"s", 1.0, 0.0},
                                                   {"sec", 1.0, 0.0},
                                                   {"seconds", 1.0, 0.0},
                                                   {"ms", 1e-3, 0.0},
                                                   {"min", 60.0, 0.0}}};
  static constexpr std::array<Unit, 9> irradiances = {{{"w_m2", 1.0, 0.0},
                                                       {"w/m2", 1.0, 0.0},
                                                       {"w/m^2", 1.0, 0.0},
                                                       {"w/m²", 1.0, 0.0},
                                                       {"wm-2", 1.0, 0.0},
                                                       {"kw/m2", 1e3, 0.0},
                                                       {"suns", 1e3, 0.0},
                                                       {"mw/cm2", 10.0, 0.0},
                                                       {"mw/cm²", 10.0, 0.0}}};
  static constexpr std::array<Unit, 7> temperatures = {{{"k", 1.0, 0.0},
                                                        {"c", 1.0, zero_celsius_K},
                                                        {"°c", 1.0, zero_celsius_K},
                                                        {"degc", 1.0, zero_celsius_K},
                                                        {"deg c", 1.0, zero_celsius_K},
                                                        {"celsius", 1.0, zero_celsius_K},
                                                        {"kelvin", 1.0, 0.0}}};
  switch (column) {
    case voltage:
      return volts;
    case current:
      return amperes;
    case irradiance:
      return irradiances;
    case temperature:
      return temperatures;
    case time:
      return seconds;
    default:
      return {};
  }
}

// In English, German, French, Spanish, Italian, Portuguese, Dutch, Polish, Czech, Swedish, Russian,
// Chinese and Japanese; small letters.
std::span<const std::string_view> names_of(Column column) {
  static constexpr std::string_view voltages[] = {
      "voltage",        "volts",    "volt",       "v",        "u",
      "module voltage", "spannung", "tension",    "tensión",  "voltaje",
      "tensione",       "tensão",   "tensao",     "spanning", "napięcie",
      "napětí",         "spänning", "напряжение", "电压",     "電圧"};
  static constexpr std::string_view currents[] = {"current",
                                                  "amps",
                                                  "amp",
                                                  "amperes",
                                                  "ampere",
                                                  "i",
                                                  "module current",
                                                  "curr",
                                                  "j",
                                                  "current density",
                                                  "stromdichte",
                                                  "strom",
                                                  "stromstärke",
                                                  "courant",
                                                  "intensité",
                                                  "corriente",
                                                  "corrente",
                                                  "stroom",
                                                  "prąd",
                                                  "proud",
                                                  "ström",
                                                  "ток",
                                                  "电流",
                                                  "電流"};
  static constexpr std::string_view irradiances[] = {"irradiance",
                                                     "g",
                                                     "poa",
                                                     "plane of array irradiance",
                                                     "irr",
                                                     "irrad",
                                                     "eeff",
                                                     "e eff",
                                                     "mean irradiance",
                                                     "poa irradiance",
                                                     "einstrahlung",
                                                     "bestrahlungsstärke",
                                                     "éclairement",
                                                     "irradiancia",
                                                     "irraggiamento",
                                                     "irradiância"};
  static constexpr std::string_view temperatures[] = {"temperature",
                                                      "temp",
                                                      "t",
                                                      "cell temperature",
                                                      "module temperature",
                                                      "t cell",
                                                      "tcell",
                                                      "cell temp",
                                                      "module temp",
                                                      "tmod",
                                                      "tdut",
                                                      "t dut",
                                                      "t mod",
                                                      "t module",
                                                      "temperatur",
                                                      "zelltemperatur",
                                                      "modultemperatur",
                                                      "température",
                                                      "temperatura",
                                                      "temperatuur"};
  static constexpr std::string_view numbers[] = {"sweep", "curve"};
  static constexpr std::string_view times[] = {"time", "relative time", "elapsed time", "zeit"};
  switch (column) {
    case voltage:
      return voltages;
    case current:
      return currents;
    case irradiance:
      return irradiances;
    case temperature:
      return temperatures;
    case time:
      return times;
    default:
      return numbers;
  }
}

std::string lower(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

// "Voltage (mV)" is a voltage in mV; "mA" a current; "V_meas", "Imod" and "SMU-1 Voltage" are
// qualified names.
struct Named {
  Column column = columns;
  std::optional<Unit> unit;
  std::string unknown_unit;
  bool is_qualified = false;
};

std::optional<Unit> unit_named(Column column, std::string_view name) {
  for (const Unit& unit : units_of(column)) {
    if (unit.name == name) return unit;
  }
  return std::nullopt;
}

bool is_one_of(std::string_view text, std::span<const std::string_view> words) {
  return std::ranges::find(words, text) != words.end();
}

// Words beside a voltage or current that leave it one of the device. Those of single points
// ("V_oc", "I_mp") are not among them.
bool is_qualifier(std::string_view word) {
  static constexpr std::string_view known[] = {
      "mod",   "module",   "cell",  "meas", "measured", "corr",  "corrected", "pv",
      "dut",   "device",   "raw",   "dc",   "smu",      "stc",   "anode",     "channel",
      "panel", "terminal", "sense", "mess", "modul",    "zelle", "ch",        "sample"};
  while (!word.empty() && std::isdigit(static_cast<unsigned char>(word.back()))) {
    word.remove_suffix(1);
  }
  return word.empty() || is_one_of(word, known);
}

// V, U or I with a qualifier before or behind it in one word: "vmod", "anodei".
Column joined_symbol(std::string_view word) {
  for (const char symbol : {'v', 'u', 'i'}) {
    const Column column = symbol == 'i' ? current : voltage;
    if (word.size() < 2) return columns;
    if (word.starts_with(symbol) && is_qualifier(word.substr(1))) return column;
    if (word.ends_with(symbol) && is_qualifier(word.substr(0, word.size() - 1))) return column;
  }
  return columns;
}

// A voltage or current with qualifiers, and perhaps its unit as the last word.
Named qualified(const std::string& cell) {
  std::string text = cell;
  for (char& c : text) c = c == '_' || c == '-' || c == '.' || c == ':' ? ' ' : c;
  Named found;
  found.is_qualified = true;
  for (const std::string_view word : words_of(text)) {
    if (found.column != columns && !found.unit) found.unit = unit_named(found.column, word);
    if (found.unit) continue;
    Column of_word = joined_symbol(word);
    for (const Column column : {voltage, current}) {
      if (is_one_of(word, names_of(column))) of_word = column;
    }
    if (of_word == columns && is_qualifier(word)) continue;
    if (of_word == columns || found.column != columns) return {};
    found.column = of_word;
  }
  return found;
}

Named named_without_brackets(std::string cell) {
  if (cell.ends_with('.')) cell.pop_back();  // "Temp."
  for (const Column column : {voltage, current, irradiance, temperature, curve_number, time}) {
    for (const std::string_view name : names_of(column)) {
      std::string text = cell;
      std::ranges::replace(text, '_', ' ');
      if (text == name) return {column, {}, {}};
      // "U / V", "U/V", "voltage mV"
      if (!text.starts_with(std::string(name) + " ") &&
          !text.starts_with(std::string(name) + "/")) {
        continue;
      }
      std::string_view rest = trimmed(std::string_view(cell).substr(name.size()));
      if (rest.starts_with('_')) rest = trimmed(rest.substr(1));
      while (rest.starts_with('/') || rest.starts_with("in ")) {
        rest = trimmed(rest.substr(rest.find_first_of("/ ") + 1));
      }
      if (const auto unit = unit_named(column, rest)) return {column, unit, {}};
    }
  }
  for (const Column column : {voltage, current}) {
    if (const auto unit = unit_named(column, cell)) return {column, unit, {}};
  }
  return qualified(cell);
}

Named named(std::string_view header_cell) {
  const std::string cell = lower(trimmed(header_cell));
  const size_t open = cell.find_first_of("([");
  if (open == std::string::npos) {
    // Small: T is a temperature.
    if (trimmed(header_cell) == "t") return {time, {}, {}};
    return named_without_brackets(cell);
  }
  Named result = named_without_brackets(std::string(trimmed(cell.substr(0, open))));
  const size_t close = cell.find_first_of(")]", open);
  const std::string unit(trimmed(std::string_view(cell).substr(open + 1, close - open - 1)));
  if (result.column == temperature && unit_named(time, unit)) result.column = time;
  if (result.column == columns) return result;
  result.unit = unit_named(result.column, unit);
  if (!result.unit && !unit.empty()) result.unknown_unit = unit;
  return result;
}

char separator_of(std::string_view header) {
  for (const char separator : {'\t', ';', ','}) {
    if (header.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  if (separator != ' ') return cells_of(line, separator);
  return words_of(line, " \t");
}

// The cells of a header. Between blanks a unit stays with its name: "Voltage (V)", "U / V",
// "I in A".
std::vector<std::string_view> split_header(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  if (separator != ' ') return split(line, separator);
  bool joins = false;
  for (const std::string_view word : split(line, separator)) {
    const bool is_link = word == "/" || word == "in";
    const bool is_inside = !cells.empty() &&
                           cells.back().find_first_of("([") != cells.back().npos &&
                           cells.back().find_first_of(")]") == cells.back().npos;
    if (!cells.empty() &&
        (joins || is_link || is_inside || word.starts_with('(') || word.starts_with('['))) {
      const auto length = static_cast<size_t>(word.data() + word.size() - cells.back().data());
      cells.back() = std::string_view(cells.back().data(), length);
    } else {
      cells.push_back(word);
    }
    joins = is_link;
  }
  return cells;
}

// Marks of a missing reading, also those of SCPI instruments for overflow and no number.
bool is_missing(std::string_view cell) {
  const std::string text = lower(cell);
  for (const std::string_view mark : {"", "nan", "na", "n/a", "inf", "+inf", "-inf", "ol", "-ol",
                                      "overload", "--", "-", "null"}) {
    if (text == mark) return true;
  }
  const auto value = number_in(cell);
  return value && std::abs(*value) > 1e30;
}

struct Header {
  char separator = ',';
  std::array<std::optional<size_t>, columns> place;
  std::array<Unit, columns> unit;
  std::array<bool, columns> has_unit{};
  std::array<std::string, columns> title;  // as written
  size_t cells = 0;
  std::optional<size_t> reading, source;  // of instrument_header()
};

// The name of a column: that of `columns` whose name in the file it is, else as it stands.
std::string_view known_as(std::string_view cell, const CurveColumns& columns) {
  for (const auto& [name, written] : columns) {
    if (written == cell) return name;
  }
  return cell;
}

// The buffer of a source-measure unit (Keithley 2450): "Reading" and "Source Value" or "Value" with
// columns of their units, which the rows state.
std::optional<Header> instrument_header(Header header, const std::vector<std::string_view>& cells) {
  std::optional<size_t> reading, source;
  for (size_t i = 0; i < cells.size(); ++i) {
    const std::string name = lower(unquoted(cells[i]));
    if (!reading && name == "reading") reading = i;
    if (!source && (name == "source value" || name == "value" || name == "source")) source = i;
  }
  if (!reading || !source) return std::nullopt;
  header.reading = reading;
  header.source = source;
  header.place[voltage] = source;
  header.place[current] = reading;
  header.title[voltage] = unquoted(cells[*source]);
  header.title[current] = unquoted(cells[*reading]);
  return header;
}

std::optional<Header> header_of(std::string_view line, const InputLocation& where,
                                const CurveColumns& columns_named) {
  Header header;
  header.separator = separator_of(line);
  header.unit.fill({"", 1.0, 0.0});
  const std::vector<std::string_view> cells = split_header(line, header.separator);
  header.cells = cells.size();
  std::array<bool, columns> is_qualified{};
  for (size_t i = 0; i < cells.size(); ++i) {
    const Named name = named(known_as(unquoted(cells[i]), columns_named));
    if (name.column == columns) continue;
    const bool needed = name.column == voltage || name.column == current;
    if (!name.unknown_unit.empty()) {
      if (!needed || name.is_qualified) continue;
      throw InputError(where, std::string(unquoted(cells[i])), "the unit " + name.unknown_unit,
                       name.column == voltage ? "V or mV" : "A, mA, µA or mA/cm²");
    }
    if (header.place[name.column]) {
      // A plain name counts before a qualified one, and of two qualified ones the first.
      if (!needed || name.is_qualified) continue;
      if (!is_qualified[name.column]) {
        throw InputError(where, std::string(unquoted(cells[i])), "a second such column",
                         "one voltage and one current; one curve a file, or a column \"curve\"");
      }
    }
    is_qualified[name.column] = name.is_qualified;
    header.place[name.column] = i;
    header.has_unit[name.column] = name.unit.has_value();
    header.title[name.column] = unquoted(cells[i]);
    header.unit[name.column] = name.unit.value_or(Unit{"", 1.0, 0.0});
  }
  if (!header.place[voltage] || !header.place[current]) return instrument_header(header, cells);
  return header;
}

// Whether all that a header names belongs to a curve; a log of a motor has more than that.
bool is_of_curve(std::string_view line, const Header& header) {
  static constexpr std::string_view beside[] = {
      "power", "p",     "leistung", "puissance", "potencia", "potenza", "time",
      "zeit",  "temps", "tiempo",   "tempo",     "date",     "index",   "point",
      "no",    "nr",    "number",   "id",        "rep",      "/",       "in",
      "watts", "watt",  "run",      "direction", "status",   "stat",    "res"};
  for (const std::string_view cell : split_header(line, header.separator)) {
    std::string text = lower(unquoted(cell));
    if (text.empty() || named(text).column != columns) continue;
    std::ranges::replace(text, '_', ' ');
    text = text.substr(0, text.find_first_of(" ([/.", 1));
    if (text.starts_with('[') || text.starts_with('(')) continue;
    if (std::ranges::find(beside, text) == std::end(beside)) return false;
  }
  return true;
}

// The rate of the voltage at each reading; per reading where there are no times. Differences over a
// few readings, so that single voltages may scatter.
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

// Reverses the currents of a curve whose current is counted into the device.
bool reverse_negative(IvSweep& sweep) {
  double nearest_V = 1e300, short_circuit_A = 0.0, highest_V = -1e300, last_A = 0.0;
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    if (std::abs(sweep.voltage_V[i]) < nearest_V) {
      nearest_V = std::abs(sweep.voltage_V[i]);
      short_circuit_A = sweep.current_A[i];
    }
    if (sweep.voltage_V[i] > highest_V) {
      highest_V = sweep.voltage_V[i];
      last_A = sweep.current_A[i];
    }
  }
  if (!(short_circuit_A < 0.0 && highest_V > 0.0 && last_A > 0.5 * short_circuit_A)) return false;
  for (double& current : sweep.current_A) current = -current;
  return true;
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& file, const CurveColumns& columns_named)
      : text_(text), lines_(text, file), file_(file), columns_named_(columns_named) {}

  std::vector<MeasuredCurve> read() {
    find_header();
    bool is_first = true;
    for (std::string_view line; lines_.next(line); is_first = false) {
      const std::vector<std::string_view> cells = split(line, header_.separator);
      if (is_first && states_units(cells)) continue;
      if (is_first && header_.reading) assign_instrument(cells);
      read_row(cells);
    }
    for (const Column column : {irradiance, temperature}) {
      if (column != temperature || !header_.place[column] || header_.has_unit[column]) continue;
      throw InputError({file_}, "temperature", "a column without a unit",
                       "its unit in the header, K or °C");
    }
    std::vector<MeasuredCurve> all;
    for (const double number : order_) all.push_back(finished(number));
    if (all.empty()) throw InputError(lines_.where(), "", "no readings", "rows of numbers");
    all.back().unread += lines_after_;
    return all;
  }

 private:
  struct Rows {
    MeasuredCurve curve;
    std::array<double, columns> sum{};
    std::array<double, columns> count{};
    std::vector<double> irradiance_W_m2, time_s;  // of each reading that has one
  };

  void find_header() {
    std::string_view line;
    std::string first;
    while (lines_.next(line)) {
      if (const auto header = header_of(line, lines_.where(), columns_named_)) {
        header_ = *header;
        read_conditions(line);
        return;
      }
      if (first.empty()) first = std::string(line.substr(0, 60));
    }
    throw InputError({file_, 1}, "", first.empty() ? "nothing" : in_quotes(first),
                     "a header that names a voltage and a current: add the line "
                     "voltage_V,current_A above the numbers");
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
      if (words.size() > 1 && !unit) unit = unit_named(name.column, lower(words[1]));
      if (!unit && name.column == irradiance && words.size() == 1) unit = Unit{"", 1.0, 0.0};
      if (!number || !unit) continue;
      stated_[name.column] = (*number + unit->offset) * unit->to_SI;
    }
  }

  // Which of reading and source is the voltage, and their units, by the first row.
  void assign_instrument(const std::vector<std::string_view>& cells) {
    const auto unit_after = [&](Column column) -> std::optional<Unit> {
      for (size_t i = *header_.place[column] + 1; i < cells.size(); ++i) {
        const std::string unit = lower(unquoted(cells[i]));
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

  // A row of units below the header.
  bool states_units(const std::vector<std::string_view>& cells) {
    for (const Column column : {voltage, current}) {
      const size_t place = *header_.place[column];
      if (place >= cells.size() || number_in(plain(cells[place]))) return false;
    }
    bool all = true;
    for (const Column column : {voltage, current, irradiance, temperature}) {
      if (!header_.place[column] || *header_.place[column] >= cells.size()) continue;
      std::string text = lower(unquoted(cells[*header_.place[column]]));
      std::erase_if(text, [](char c) { return c == '(' || c == ')' || c == '[' || c == ']'; });
      const auto unit = unit_named(column, text);
      all = all && unit.has_value();
      if (!unit) continue;
      header_.unit[column] = *unit;
      header_.has_unit[column] = true;
    }
    return all;
  }

  // A decimal comma, where none separates.
  std::string plain(std::string_view cell) const {
    std::string text(unquoted(cell));
    const bool may_be_comma = header_.separator != ',';
    if (may_be_comma && text.find('.') == std::string::npos) std::ranges::replace(text, ',', '.');
    return text;
  }

  std::optional<double> value(Column column, const std::vector<std::string_view>& cells) const {
    const size_t place = *header_.place[column];
    const std::string cell = place < cells.size() ? plain(cells[place]) : "";
    if (is_missing(cell)) return std::nullopt;
    Unit unit = header_.unit[column];
    std::string_view text = cell;
    // "0.52 V"
    const size_t digits = text.find_last_of("0123456789.") + 1;
    if (digits > 0 && digits < text.size()) {
      const auto stated = unit_named(column, lower(trimmed(text.substr(digits))));
      if (stated) text = text.substr(0, digits);
      unit = stated.value_or(unit);
    }
    const double number = require_number(text, lines_.where(), header_.title[column]);
    return (number + unit.offset) * unit.to_SI;
  }

  // Lines below the readings ("End of data") have no voltage; a reading behind one makes it a
  // mistake.
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

  void read_row(const std::vector<std::string_view>& cells) {
    // For example decimal commas, which would shift the columns after them.
    if (header_.separator == ',' && header_.cells == 2 && cells.size() == 4) {
      throw InputError(lines_.where(), "", "a row of 4 cells",
                       "2, as in the header: separate decimal commas by semicolons");
    }
    if (is_after_readings(cells)) return;
    const double number =
        header_.place[curve_number] ? value(curve_number, cells).value_or(0.0) : 0.0;
    const auto [found, is_new] = curves_.try_emplace(number);
    if (is_new) order_.push_back(number);
    Rows& rows = found->second;
    const auto v = value(voltage, cells), i = value(current, cells);
    if (!v || !i) {
      ++rows.curve.unread;
      return;
    }
    rows.curve.sweep.voltage_V.push_back(*v);
    rows.curve.sweep.current_A.push_back(*i);
    for (const Column column : {irradiance, temperature}) {
      if (!header_.place[column]) continue;
      const auto one = value(column, cells);
      if (!one) continue;
      rows.sum[column] += *one;
      rows.count[column] += 1.0;
      if (column == irradiance) rows.irradiance_W_m2.push_back(*one);
    }
    // Times of day ("08:00") have no use here.
    if (header_.place[time] && *header_.place[time] < cells.size()) {
      const auto number_s = number_in(plain(cells[*header_.place[time]]));
      if (number_s) rows.time_s.push_back(*number_s * header_.unit[time].to_SI);
    }
  }

  MeasuredCurve finished(double number) {
    Rows& rows = curves_.at(number);
    const auto mean = [&](Column column) -> std::optional<double> {
      if (rows.count[column] == 0.0 && stated_[column]) {
        rows.curve.stated += (rows.curve.stated.empty() ? "" : ", ") +
                             readable_number(*stated_[column], 5) +
                             (column == irradiance ? " W/m²" : " K");
      }
      if (rows.count[column] == 0.0) return stated_[column];
      return rows.sum[column] / rows.count[column];
    };
    MeasuredCurve& curve = rows.curve;
    curve.irradiance_W_m2 = mean(irradiance);
    curve.temperature_K = mean(temperature);
    curve.is_density = header_.unit[current].name.find('/') != std::string_view::npos;
    curve.is_reversed = reverse_negative(curve.sweep);
    const size_t readings = curve.sweep.voltage_V.size();
    if (rows.irradiance_W_m2.size() == readings && curve.irradiance_W_m2.value_or(0.0) > 0.0) {
      for (const double one : rows.irradiance_W_m2) {
        curve.sweep.light.push_back(one / *curve.irradiance_W_m2);
      }
      if (std::ranges::min(curve.sweep.light) == std::ranges::max(curve.sweep.light)) {
        curve.sweep.light.clear();
      }
    }
    find_rates(curve.sweep, rows.time_s);
    return std::move(curve);
  }

  std::string_view text_;
  DataLines lines_;
  std::string file_;
  const CurveColumns& columns_named_;
  Header header_;
  std::map<double, Rows> curves_;
  std::vector<double> order_;
  std::array<std::optional<double>, columns> stated_;  // above the header
  std::optional<InputError> after_readings_;           // the first line without a voltage
  size_t lines_after_ = 0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// Order of the readings: by rising voltage, and at equal voltage by falling current.
std::vector<size_t> order_of(const IvSweep& sweep) {
  std::vector<size_t> order(sweep.voltage_V.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, [&](size_t a, size_t b) {
    if (sweep.voltage_V[a] != sweep.voltage_V[b]) return sweep.voltage_V[a] < sweep.voltage_V[b];
    return sweep.current_A[a] > sweep.current_A[b];
  });
  return order;
}

void remove(IvSweep& sweep, const std::vector<char>& out) {
  sweep = sweep.without(out);
}

// A single reading off both neighbours, which agree with each other and with those beyond.
size_t take_spikes(IvSweep& sweep) {
  const std::vector<size_t> order = order_of(sweep);
  const double scale_A = std::ranges::max(sweep.current_A);
  constexpr double far = 0.1, alike = 0.25;
  std::vector<char> out(order.size(), 0);
  size_t count = 0;
  for (size_t k = 2; k + 2 < order.size(); ++k) {
    const double at = sweep.current_A[order[k]];
    const std::array<double, 4> near = {
        sweep.current_A[order[k - 2]], sweep.current_A[order[k - 1]], sweep.current_A[order[k + 1]],
        sweep.current_A[order[k + 2]]};
    const auto [low, high] = std::ranges::minmax(near);
    const double off = at > high ? at - high : low - at;
    if (off > far * scale_A && high - low < alike * off) {
      out[order[k]] = 1;
      ++count;
    }
  }
  // If there are many, they are not outliers.
  if (count * 20 > order.size()) return 0;
  if (count > 0) remove(sweep, out);
  return count;
}

}  // namespace
}  // namespace curve_text

IvSweep IvSweep::without(const std::vector<char>& out) const {
  IvSweep kept;
  kept.is_timed = is_timed;
  const auto keep = [&out](const std::vector<double>& all, std::vector<double>& some) {
    for (size_t i = 0; i < all.size(); ++i) {
      if (out[i] == 0) some.push_back(all[i]);
    }
  };
  keep(voltage_V, kept.voltage_V);
  keep(current_A, kept.current_A);
  keep(light, kept.light);
  keep(rate_V_s, kept.rate_V_s);
  return kept;
}

std::vector<MeasuredCurve> curves_in(std::string_view text, const std::string& file,
                                     const CurveColumns& columns) {
  return curve_text::Reader(text, file, columns).read();
}

bool is_curve_header(std::string_view line, const CurveColumns& columns) {
  try {
    const auto header = curve_text::header_of(line, {}, columns);
    return header && (!columns.empty() || curve_text::is_of_curve(line, *header));
  } catch (const InputError&) {
    return true;  // names them, but in a way that the reader refuses
  }
}

std::vector<std::string> curve_header_cells(std::string_view line) {
  using namespace curve_text;
  std::vector<std::string> cells;
  for (const std::string_view cell : split_header(line, separator_of(line))) {
    cells.emplace_back(unquoted(cell));
  }
  return cells;
}

UnsteadyLight take_unsteady_light(IvSweep& sweep, double noise) {
  using namespace curve_text;
  const std::vector<size_t> order = order_of(sweep);
  if (order.size() < 20) return {};
  const double open_V = sweep.voltage_V[order.back()];
  std::vector<size_t> flat;  // readings of the flat part, by rising voltage
  for (const size_t i : order) {
    if (sweep.voltage_V[i] < 0.6 * open_V) flat.push_back(i);
  }
  if (flat.size() < 12) return {};
  const auto volts = [&](size_t k) { return sweep.voltage_V[flat[k]]; };
  const auto amperes = [&](size_t k) { return sweep.current_A[flat[k]]; };
  // The falling line through two of the readings that most readings agree with.
  const double scale_A = std::ranges::max(sweep.current_A), close_A = 3.0 * noise * scale_A;
  const double steepest_S = 0.1 * scale_A / (0.6 * open_V);
  size_t most = 0;
  double at_zero_A = 0.0, slope_S = 0.0;
  const size_t stride = std::max<size_t>(1, flat.size() / 60);
  for (size_t a = 0; a < flat.size(); a += stride) {
    for (size_t b = a + flat.size() / 4; b < flat.size(); b += stride) {
      if (!(volts(b) > volts(a))) continue;
      const double slope = (amperes(b) - amperes(a)) / (volts(b) - volts(a));
      if (slope > 0.0 || slope < -steepest_S) continue;
      size_t agree = 0;
      for (size_t k = 0; k < flat.size(); ++k) {
        agree += std::abs(amperes(k) - amperes(a) - slope * (volts(k) - volts(a))) < close_A;
      }
      if (agree <= most) continue;
      most = agree;
      slope_S = slope;
      at_zero_A = amperes(a) - slope * volts(a);
    }
  }
  if (5 * most < 3 * flat.size()) return {};  // no line
  UnsteadyLight found;
  std::vector<char> out(order.size(), 0);
  constexpr size_t shortest = 3, beside = 3;
  constexpr double least = 0.01, half = 0.5;
  const auto off_A = [&](size_t k) { return amperes(k) - at_zero_A - slope_S * volts(k); };
  for (size_t k = 0, end = 0; k < flat.size(); k = end + 1) {
    for (end = k; end < flat.size() && std::abs(off_A(end)) > close_A;) ++end;
    if (end - k < shortest) continue;
    // With the edges, which go over into the line.
    const double sign = off_A(k + (end - k) / 2) < 0.0 ? -1.0 : 1.0;
    size_t first = k, last = end;
    while (first > 0 && sign * off_A(first - 1) > close_A / 3.0) --first;
    while (last < flat.size() && sign * off_A(last) > close_A / 3.0) ++last;
    double largest_A = 0.0, lowest_A = amperes(first), rise_A = 0.0;
    for (size_t j = first; j < last; ++j) largest_A = std::max(largest_A, std::abs(off_A(j)));
    for (size_t j = first - std::min(first, beside); j < std::min(last + beside, flat.size());
         ++j) {
      lowest_A = std::min(lowest_A, amperes(j));
      rise_A = std::max(rise_A, amperes(j) - lowest_A);
    }
    // Without light that changes no current rises with the voltage.
    if (largest_A < least * scale_A || rise_A < half * largest_A) continue;
    for (size_t j = first; j < last; ++j) out[flat[j]] = 1;
    found.largest = std::max(found.largest, largest_A / scale_A);
    if (found.readings == 0) found.from_V = volts(first);
    found.to_V = volts(last - 1);
    found.readings += last - first;
    end = std::max(end, last);
  }
  if (found.readings > 0) remove(sweep, out);
  return found;
}

CurveCleaning clean_curve(IvSweep& sweep) {
  using namespace curve_text;
  CurveCleaning cleaning;
  if (sweep.voltage_V.size() < 8 || sweep.current_A.size() != sweep.voltage_V.size()) return {};
  const double scale_A = std::ranges::max(sweep.current_A);
  if (!(scale_A > 0.0)) return {};
  cleaning.spikes = take_spikes(sweep);
  const std::vector<size_t> order = order_of(sweep);
  const auto volts = [&](size_t k) { return sweep.voltage_V[order[k]]; };
  const auto amperes = [&](size_t k) { return sweep.current_A[order[k]]; };
  constexpr double near_zero = 0.03, least_fall = 0.01, held = 0.25;
  // The longest tail within the band about zero, then the longest part of it that stays in place.
  size_t band = order.size();
  while (band > 0 && std::abs(amperes(band - 1)) <= near_zero * scale_A) --band;
  for (size_t first = band; first + 1 < order.size(); ++first) {
    double low = amperes(first), high = low;
    for (size_t k = first; k < order.size(); ++k) {
      low = std::min(low, amperes(k));
      high = std::max(high, amperes(k));
    }
    // The largest slope before these readings, over at least a tenth of the short-circuit current.
    double steepest_S = 0.0;
    for (size_t k = first; k-- > 0;) {
      const double fall_A = amperes(k) - high;
      const double run_V = volts(first) - volts(k);
      if (fall_A < 0.1 * scale_A) continue;
      if (run_V > 0.0) steepest_S = std::max(steepest_S, fall_A / run_V);
      if (fall_A > 0.5 * scale_A) break;
    }
    const double expected_A = steepest_S * (volts(order.size() - 1) - volts(first));
    if (!(expected_A > least_fall * scale_A && high - low < held * expected_A)) continue;
    // A point of the falling curve that the band reached does not belong to the tail.
    std::vector<double> tail;
    for (size_t k = first; k < order.size(); ++k) tail.push_back(amperes(k));
    const double usual_A = median(tail);
    for (double& one : tail) one = std::abs(one - usual_A);
    const double around_A = std::max(5.0 * median(tail), 2e-3 * scale_A);
    std::vector<char> out(order.size(), 0);
    for (size_t k = first; k < order.size(); ++k) {
      if (cleaning.clipped == 0 && std::abs(amperes(k) - usual_A) > around_A) continue;
      if (cleaning.clipped == 0) cleaning.clipped_from_V = volts(k);
      out[order[k]] = 1;
      ++cleaning.clipped;
    }
    cleaning.clipped_A = usual_A;
    remove(sweep, out);
    break;
  }
  return cleaning;
}

}  // namespace photorque
