#include "photovoltaics/fit/curve_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>

#include "core/text/parse.h"

namespace photorque::curve_text {
namespace {

constexpr double zero_celsius_K = 273.15;

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

// Names of a column in English, German, French, Spanish, Italian, Portuguese, Dutch, Polish, Czech,
// Swedish, Russian, Chinese and Japanese, in small letters.
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

bool is_one_of(std::string_view text, std::span<const std::string_view> words) {
  return std::ranges::find(words, text) != words.end();
}

// Whether a word may qualify a voltage or current of the device. Words for single points ("V_oc",
// "I_mp") are excluded.
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
      // A name may be followed by a unit: "U / V", "U/V", "voltage mV".
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

}  // namespace

std::optional<Unit> unit_named(Column column, std::string_view name) {
  for (const Unit& unit : units_of(column)) {
    if (unit.name == name) return unit;
  }
  return std::nullopt;
}

Named named(std::string_view header_cell) {
  const std::string cell = lower_case(trimmed(header_cell));
  const size_t open = cell.find_first_of("([");
  if (open == std::string::npos) {
    // Only a small t is a time: T is a temperature.
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

}  // namespace photorque::curve_text
