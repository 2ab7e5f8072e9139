#include "photovoltaics/fit/curve_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <span>

#include "core/errors.h"
#include "core/text/parse.h"

namespace photorque {
namespace curve_text {
namespace {

constexpr double zero_celsius_K = 273.15;

enum Column { voltage, current, irradiance, temperature, curve_number, columns };

struct Unit {
  std::string_view name;
  double to_SI, offset;  // SI = (value + offset) · to_SI
};

std::span<const Unit> units_of(Column column) {
  static constexpr std::array<Unit, 4> volts = {
      {{"v", 1.0, 0.0}, {"mv", 1e-3, 0.0}, {"volts", 1.0, 0.0}, {"volt", 1.0, 0.0}}};
  static constexpr std::array<Unit, 7> amperes = {{{"a", 1.0, 0.0},
                                                   {"ma", 1e-3, 0.0},
                                                   {"ua", 1e-6, 0.0},
                                                   {"µa", 1e-6, 0.0},
                                                   {"μa", 1e-6, 0.0},
                                                   {"amps", 1.0, 0.0},
                                                   {"amp", 1.0, 0.0}}};
  static constexpr std::array<Unit, 5> irradiances = {{{"w_m2", 1.0, 0.0},
                                                       {"w/m2", 1.0, 0.0},
                                                       {"w/m^2", 1.0, 0.0},
                                                       {"w/m²", 1.0, 0.0},
                                                       {"mw/cm2", 10.0, 0.0}}};
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
  static constexpr std::string_view currents[] = {
      "current", "amps",        "amp",     "amperes",   "ampere",    "i",        "module current",
      "strom",   "stromstärke", "courant", "intensité", "corriente", "corrente", "stroom",
      "prąd",    "proud",       "ström",   "ток",       "电流",      "電流"};
  static constexpr std::string_view irradiances[] = {"irradiance",    "g",
                                                     "poa",           "plane of array irradiance",
                                                     "einstrahlung",  "bestrahlungsstärke",
                                                     "éclairement",   "irradiancia",
                                                     "irraggiamento", "irradiância"};
  static constexpr std::string_view temperatures[] = {"temperature",
                                                      "temp",
                                                      "t",
                                                      "cell temperature",
                                                      "module temperature",
                                                      "t cell",
                                                      "tcell",
                                                      "cell temp",
                                                      "module temp",
                                                      "temperatur",
                                                      "zelltemperatur",
                                                      "modultemperatur",
                                                      "température",
                                                      "temperatura",
                                                      "temperatuur"};
  static constexpr std::string_view numbers[] = {"sweep", "curve"};
  switch (column) {
    case voltage:
      return voltages;
    case current:
      return currents;
    case irradiance:
      return irradiances;
    case temperature:
      return temperatures;
    default:
      return numbers;
  }
}

std::string lower(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

// "Voltage (mV)" is a voltage in mV; "mA" a current.
struct Named {
  Column column = columns;
  std::optional<Unit> unit;
  std::string unknown_unit;
};

std::optional<Unit> unit_named(Column column, std::string_view name) {
  for (const Unit& unit : units_of(column)) {
    if (unit.name == name) return unit;
  }
  return std::nullopt;
}

Named named_without_brackets(const std::string& cell) {
  for (const Column column : {voltage, current, irradiance, temperature, curve_number}) {
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
  return {};
}

Named named(std::string_view header_cell) {
  const std::string cell = lower(trimmed(header_cell));
  const size_t open = cell.find_first_of("([");
  if (open == std::string::npos) return named_without_brackets(cell);
  Named result = named_without_brackets(std::string(trimmed(cell.substr(0, open))));
  if (result.column == columns) return result;
  const size_t close = cell.find_first_of(")]", open);
  const std::string unit(trimmed(std::string_view(cell).substr(open + 1, close - open - 1)));
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
};

// The name of a column: that of `columns` whose name in the file it is, else as it stands.
std::string_view known_as(std::string_view cell, const CurveColumns& columns) {
  for (const auto& [name, written] : columns) {
    if (written == cell) return name;
  }
  return cell;
}

std::optional<Header> header_of(std::string_view line, const InputLocation& where,
                                const CurveColumns& columns_named) {
  Header header;
  header.separator = separator_of(line);
  header.unit.fill({"", 1.0, 0.0});
  const std::vector<std::string_view> cells = split(line, header.separator);
  for (size_t i = 0; i < cells.size(); ++i) {
    const Named name = named(known_as(unquoted(cells[i]), columns_named));
    if (name.column == columns) continue;
    const bool needed = name.column == voltage || name.column == current;
    if (!name.unknown_unit.empty()) {
      if (!needed) continue;
      throw InputError(where, std::string(unquoted(cells[i])), "the unit " + name.unknown_unit,
                       name.column == voltage ? "V or mV" : "A, mA or µA");
    }
    if (header.place[name.column]) {
      if (!needed) continue;
      throw InputError(where, std::string(unquoted(cells[i])), "a second such column",
                       "one voltage and one current; one curve a file, or a column \"curve\"");
    }
    header.place[name.column] = i;
    header.has_unit[name.column] = name.unit.has_value();
    header.title[name.column] = unquoted(cells[i]);
    if (name.unit) header.unit[name.column] = *name.unit;
  }
  if (!header.place[voltage] || !header.place[current]) return std::nullopt;
  return header;
}

// Whether all that a header names belongs to a curve; a log of a motor has more than that.
bool is_of_curve(std::string_view line, const Header& header) {
  static constexpr std::string_view beside[] = {
      "power",  "p",      "leistung", "puissance", "potencia", "potenza", "time", "zeit",
      "temps",  "tiempo", "tempo",    "date",      "index",    "point",   "no",   "nr",
      "number", "id",     "rep",      "/",         "in",       "#"};
  for (const std::string_view cell : split(line, header.separator)) {
    std::string text = lower(unquoted(cell));
    if (text.empty() || named(text).column != columns) continue;
    std::ranges::replace(text, '_', ' ');
    text = text.substr(0, text.find_first_of(" ([/.", 1));
    if (text.starts_with('[') || text.starts_with('(')) continue;
    if (std::ranges::find(beside, text) == std::end(beside)) return false;
  }
  return true;
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
      : lines_(text, file), file_(file), columns_named_(columns_named) {}

  std::vector<MeasuredCurve> read() {
    find_header();
    bool is_first = true;
    for (std::string_view line; lines_.next(line); is_first = false) {
      const std::vector<std::string_view> cells = split(line, header_.separator);
      if (is_first && states_units(cells)) continue;
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
    return all;
  }

 private:
  struct Rows {
    MeasuredCurve curve;
    std::array<double, columns> sum{};
    std::array<double, columns> count{};
  };

  void find_header() {
    std::string_view line;
    std::string first;
    while (lines_.next(line)) {
      if (const auto header = header_of(line, lines_.where(), columns_named_)) {
        header_ = *header;
        return;
      }
      if (first.empty()) first = std::string(line.substr(0, 60));
    }
    throw InputError({file_, 1}, "", first.empty() ? "nothing" : in_quotes(first),
                     "a header that names a voltage and a current: add the line "
                     "voltage_V,current_A above the numbers");
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
    const double number = require_number(cell, lines_.where(), header_.title[column]);
    return (number + header_.unit[column].offset) * header_.unit[column].to_SI;
  }

  void read_row(const std::vector<std::string_view>& cells) {
    // For example decimal commas, which would shift the columns after them.
    size_t used = 0;
    for (const auto& place : header_.place) used = std::max(used, place ? *place + 1 : 0);
    if (header_.separator == ',' && cells.size() > used && used == 2 && cells.size() == 4) {
      throw InputError(lines_.where(), "", "a row of 4 cells",
                       "2, as in the header: separate decimal commas by semicolons");
    }
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
    }
  }

  MeasuredCurve finished(double number) {
    Rows& rows = curves_.at(number);
    const auto mean = [&](Column column) -> std::optional<double> {
      if (rows.count[column] == 0.0) return std::nullopt;
      return rows.sum[column] / rows.count[column];
    };
    rows.curve.irradiance_W_m2 = mean(irradiance);
    rows.curve.temperature_K = mean(temperature);
    rows.curve.is_reversed = reverse_negative(rows.curve.sweep);
    return std::move(rows.curve);
  }

  DataLines lines_;
  std::string file_;
  const CurveColumns& columns_named_;
  Header header_;
  std::map<double, Rows> curves_;
  std::vector<double> order_;
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
  IvSweep kept;
  for (size_t i = 0; i < out.size(); ++i) {
    if (out[i] != 0) continue;
    kept.voltage_V.push_back(sweep.voltage_V[i]);
    kept.current_A.push_back(sweep.current_A[i]);
  }
  sweep = std::move(kept);
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
  for (const std::string_view cell : split(line, separator_of(line))) {
    cells.emplace_back(unquoted(cell));
  }
  return cells;
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
