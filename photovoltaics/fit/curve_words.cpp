#include "photovoltaics/fit/curve_words.h"

#include <algorithm>
#include <cctype>
#include <utility>
#include <vector>

#include "core/text/parse.h"

namespace photorque::curve_text {
namespace {

constexpr double zero_celsius_K = 273.15;

// Names of one unit, separated by commas, in small letters.
struct UnitNames {
  Column column;
  std::string_view names;
  double to_SI, offset = 0.0;
};

// A current density is the current of 1 cm². Units of an area are compared in the form "macm2".
constexpr UnitNames units[] = {
    {voltage, "v,volts,volt", 1.0},
    {voltage, "mv", 1e-3},
    {current, "a,amps,amp,a/cm2", 1.0},
    {current, "ma,ma/cm2", 1e-3},
    {current, "ua,µa,μa", 1e-6},
    {current, "a/m2", 1e-4},
    {irradiance, "w/m2", 1.0},
    {irradiance, "kw/m2,suns", 1e3},
    {irradiance, "mw/cm2", 10.0},
    {temperature, "k,kelvin", 1.0},
    {temperature, "c,°c,degc,deg c,celsius", 1.0, zero_celsius_K},
    {time, "s,sec,seconds", 1.0},
    {time, "ms", 1e-3},
    {time, "min", 60.0},
};

// Names of the columns, separated by commas, in English, German, French, Spanish, Italian,
// Portuguese, Dutch, Polish, Czech, Swedish, Russian, Chinese and Japanese, in small letters.
constexpr std::pair<Column, std::string_view> names[] = {
    {voltage,
     "voltage,volts,volt,v,u,module voltage,spannung,tension,tensión,voltaje,tensione,tensão,"
     "tensao,spanning,napięcie,napětí,spänning,напряжение,电压,電圧"},
    {current,
     "current,amps,amp,amperes,ampere,i,module current,curr,j,current density,stromdichte,strom,"
     "stromstärke,courant,intensité,corriente,corrente,stroom,prąd,proud,ström,ток,电流,電流"},
    {irradiance,
     "irradiance,g,poa,plane of array irradiance,irr,irrad,eeff,e eff,mean irradiance,"
     "poa irradiance,einstrahlung,bestrahlungsstärke,éclairement,irradiancia,irraggiamento,"
     "irradiância"},
    {temperature,
     "temperature,temp,t,cell temperature,module temperature,t cell,tcell,cell temp,module temp,"
     "tmod,tdut,t dut,t mod,t module,temperatur,zelltemperatur,modultemperatur,température,"
     "temperatura,temperatuur"},
    {curve_number, "sweep,curve"},
    {time, "time,relative time,elapsed time,zeit"},
};

// Whether a word may qualify a voltage or current of the device. Words for single points ("V_oc",
// "I_mp") are excluded.
bool is_qualifier(std::string_view word) {
  constexpr std::string_view known =
      "mod,module,cell,meas,measured,corr,corrected,pv,dut,device,raw,dc,smu,stc,anode,channel,"
      "panel,terminal,sense,mess,modul,zelle,ch,sample,set,a,light,lit,illum,illuminated";
  while (!word.empty() && std::isdigit(static_cast<unsigned char>(word.back()))) {
    word.remove_suffix(1);
  }
  return word.empty() || is_listed(word, known);
}

// V, U, I or J with a qualifier before or behind it in one word: "vmod", "anodei".
Column joined_symbol(std::string_view word) {
  for (const char symbol : {'v', 'u', 'i', 'j'}) {
    const Column column = symbol == 'i' || symbol == 'j' ? current : voltage;
    if (word.size() < 2) return columns;
    if (word.starts_with(symbol) && is_qualifier(word.substr(1))) return column;
    // The symbol ends a longer word: "ai" is an analog input, "av" a mean.
    const bool is_last = word.size() > 2 && word.ends_with(symbol);
    if (is_last && is_qualifier(word.substr(0, word.size() - 1))) return column;
  }
  return columns;
}

// A voltage or current with qualifiers, and perhaps its unit as the last word.
Named qualified(const std::string& cell) {
  std::string text = cell;
  for (char& c : text) c = c == '_' || c == '-' || c == '.' || c == ':' ? ' ' : c;
  Named found;
  // A measured value has priority over the one that was set.
  found.match = text.find("set") == std::string::npos ? Named::qualified : Named::set_value;
  for (const std::string_view word : words_of(text)) {
    if (found.column != columns && !found.unit) found.unit = unit_named(found.column, word);
    if (found.unit) continue;
    Column of_word = joined_symbol(word);
    // Without a number: "Current1". A short word with a number is another symbol.
    constexpr size_t shortest = 4;
    const std::string_view stem = word.substr(0, word.find_last_not_of("0123456789") + 1);
    for (const auto& [column, list] : names) {
      const bool needed = column == voltage || column == current;
      const bool is_name =
          is_listed(word, list) || (stem.size() >= shortest && is_listed(stem, list));
      if (needed && is_name) of_word = column;
    }
    if (of_word == columns && is_qualifier(word)) continue;
    if (of_word == columns || found.column != columns) return {};
    found.column = of_word;
  }
  return found;
}

// A unit of an area without its signs: "mA/cm²", "mA cm⁻²" and "mA*cm^-2" are "macm2".
std::string of_area(std::string_view unit) {
  std::string text;
  for (size_t i = 0; i < unit.size(); ++i) {
    constexpr std::pair<std::string_view, std::string_view> written[] = {
        {"²", "2"}, {"⁻", ""}, {"·", ""}};
    const auto sign = std::ranges::find_if(
        written, [&](const auto& one) { return unit.substr(i).starts_with(one.first); });
    if (sign != std::end(written)) {
      text += sign->second;
      i += sign->first.size() - 1;
    } else if (std::string_view(" /*^_-").find(unit[i]) == std::string_view::npos) {
      text += unit[i];
    }
  }
  return text.ends_with('2') ? text : std::string(unit);
}

Named named_without_brackets(std::string cell) {
  if (cell.ends_with('.')) cell.pop_back();  // "Temp."
  for (const auto& [column, list] : names) {
    for (const std::string_view name : cells_of(list)) {
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
  const std::string written = of_area(name);
  for (const UnitNames& unit : units) {
    if (unit.column != column) continue;
    const std::vector<std::string_view> known = cells_of(unit.names);
    const auto found = std::ranges::find(known, written, of_area);
    if (found != known.end()) return Unit{*found, unit.to_SI, unit.offset};
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
  std::string_view unit = trimmed(std::string_view(cell).substr(open + 1, close - open - 1));
  if (unit.starts_with("in ")) unit = trimmed(unit.substr(3));  // "Voltage (in V)"
  if (result.column == temperature && unit_named(time, unit)) result.column = time;
  if (result.column == columns) return result;
  result.unit = unit_named(result.column, unit);
  if (!result.unit && !unit.empty()) result.unknown_unit = std::string(unit);
  return result;
}

Named named_by_unit(std::string_view header_cell) {
  constexpr std::string_view excluded =
      "voc,uoc,isc,jsc,oc,sc,mp,pm,vmp,imp,jmp,vmpp,impp,jmpp,vmax,imax,vpm,ipm,pmax,open,short,"
      "mpp,max,min,"
      "maximum,minimum,sd,std,stdev,sigma,err,error,unc,uncertainty,noise,dark,limit,compliance,"
      "range,start,stop,step,delta";
  const std::string cell = lower_case(trimmed(header_cell));
  std::string words = cell;
  for (char& c : words) {
    if (std::isalpha(static_cast<unsigned char>(c)) == 0) c = ' ';
  }
  for (const std::string_view word : words_of(words)) {
    if (is_listed(word, excluded)) return {};
  }
  const bool has_bracket = cell.ends_with(')') || cell.ends_with(']');
  for (size_t i = 1; i < cell.size(); ++i) {
    if (std::string_view(has_bracket ? "([" : "/_").find(cell[i]) == std::string_view::npos) {
      continue;
    }
    const std::string_view unit =
        std::string_view(cell).substr(i + 1, cell.size() - i - 1 - has_bracket);
    for (const Column column : {voltage, current}) {
      if (const auto found = unit_named(column, trimmed(unit))) {
        return {column, found, {}, Named::by_unit};
      }
    }
  }
  return {};
}

bool names_density(std::string_view header_cell) {
  const std::string cell = lower_case(trimmed(header_cell));
  return named(cell).column == current &&
         (cell.starts_with('j') || cell.find("dens") != cell.npos ||
          cell.find("dicht") != cell.npos);
}

}  // namespace photorque::curve_text
