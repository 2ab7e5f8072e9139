#include "tools/sweeps/labels.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/settings/settings.h"
#include "core/text/parse.h"
#include "tools/runs/console.h"

namespace photorque {
namespace {

// Units in the names of keys that need a fraction bar or special characters in a label.
constexpr std::array<std::pair<const char*, const char*>, 29> unit_texts = {
    {{"W_m2", "W/m²"},       {"W_K", "W/K"},       {"mW_cm2", "mW/cm²"}, {"uN_m", "µN m"},
     {"m_s2", "m/s²"},       {"m_s", "m/s"},       {"rad_s", "rad/s"},   {"rad_s2", "rad/s²"},
     {"deg_s", "deg/s"},     {"W_sr", "W/sr"},     {"um", "µm"},         {"ohm", "Ω"},
     {"kg_m3", "kg/m³"},     {"uT", "µT"},         {"us", "µs"},         {"kg_s", "kg/s"},
     {"kg_m", "kg/m"},       {"kg_mol", "kg/mol"}, {"g_mol", "g/mol"},   {"A_W", "A/W"},
     {"V_K", "V/K"},         {"J_kg", "J/kg"},     {"Wh_kg", "Wh/kg"},   {"S_m", "S/m"},
     {"cm_s", "cm/s"},       {"mm_s", "mm/s"},     {"km_h", "km/h"},     {"rev_s", "rev/s"},
     {"m_per_Ah", "m/(A h)"}}};

std::string spaced(std::string text) {
  std::ranges::replace(text, '_', ' ');
  return text;
}

}  // namespace

std::string printed_unit(const std::string& unit) {
  const auto at = std::ranges::find_if(unit_texts, [&](const auto& u) { return unit == u.first; });
  if (at != unit_texts.end()) return at->second;
  std::string text = unit.starts_with("per_") ? "1/" + unit.substr(4) : unit;
  for (const auto& [from, to] :
       {std::pair<std::string, std::string>{"_per_", "/"}, {"2", "²"}, {"3", "³"}}) {
    for (size_t i = 0; (i = text.find(from, i)) != std::string::npos; i += to.size()) {
      text.replace(i, from.size(), to);
    }
  }
  return spaced(text);
}

std::string AxisLabel::with(const std::string& value) const {
  const auto number = number_in(value);
  return name + " " + (number ? show(*number) : value) + (unit.empty() ? "" : " " + unit);
}

AxisLabel label_of(const SweepAxis& axis) {
  std::string last = axis.key.substr(axis.key.rfind('.') + 1);
  std::string component;
  if (const size_t bracket = last.find('['); bracket != std::string::npos) {
    const std::string index = last.substr(bracket + 1, last.find(']') - bracket - 1);
    last.resize(bracket);
    const bool point = last.starts_with("position") || last.starts_with("direction") ||
                       last.starts_with("aim") || last.starts_with("offset");
    constexpr const char* xyz[] = {" x", " y", " z"};
    component = point && index.size() == 1 && index[0] < '3' ? xyz[index[0] - '0'] : " " + index;
  }
  const KeyUnit unit = unit_of_key(last);
  return {axis.name.empty() ? spaced(unit.stem) + component : axis.name, printed_unit(unit.unit)};
}

AxisLabel label_of_figure(const std::string& column) {
  std::string rest = column, before;
  if (rest.size() > 1 && rest[0] == 'p' && rest[1] >= '0' && rest[1] <= '9') {
    const size_t end = rest.find('_');
    std::string percent = rest.substr(1, end - 1);
    rest = rest.substr(end + 1);
    before = percent + " % of built copies reach: ";
  }
  const bool absolute = rest.starts_with("abs_");
  if (absolute) rest = rest.substr(4);
  const KeyUnit unit = unit_of_key(rest);
  const std::string name = spaced(unit.stem);
  return {before + (absolute ? "|" + name + "|" : name), printed_unit(unit.unit)};
}

std::string title_of_figure(const SweepPlan& plan, const std::string& column) {
  std::string text = label_of_figure(column).name;
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  const auto name_of = [](const std::string& key) {
    SweepAxis axis;
    axis.key = key;
    return label_of(axis).name;
  };
  std::string within;
  for (const MeanOver& mean : plan.mean_over) within += ", mean over " + name_of(mean.key);
  for (const WorstOver& worst : plan.worst_over) within += ", worst over " + name_of(worst.key);
  return within.empty() ? text : text + " (" + within.substr(2) + ")";
}

}  // namespace photorque
