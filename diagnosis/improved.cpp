#include "diagnosis/improved.h"

#include <cmath>
#include <cstdlib>
#include <optional>

#include "core/settings/settings.h"
#include "core/text/format.h"
#include "scenes/experiment/toml.h"

namespace photorque {
namespace {

using TomlTable = SettingsNode::Table;

// The number rounded to the digits of a format; integers without a decimal point.
SettingsNode number(double value, const char* format) {
  const double rounded = std::strtod(printed(format, value).c_str(), nullptr);
  constexpr double largest_written_whole = 1e6;
  if (std::trunc(rounded) == rounded && std::abs(rounded) < largest_written_whole) {
    return {static_cast<int64_t>(rounded)};
  }
  return {rounded};
}

SettingsNode numbers(const std::vector<double>& values, const char* format) {
  if (values.size() == 1) return number(values.front(), format);
  SettingsNode::Array all;
  for (const double value : values) all.push_back(number(value, format));
  return {std::move(all)};
}

// Whether all standard errors are known and at least one is positive. Otherwise the value is
// written as exact, because a prior requires a positive sigma.
bool has_sigma(const FittedParameter& p) {
  bool any = false;
  for (const double s : p.sigma) {
    if (!std::isfinite(s) || s < 0.0) return false;
    any = any || s > 0.0;
  }
  return any && p.sigma.size() == p.value.size();
}

SettingsNode value_of(const FittedParameter& p) {
  SettingsNode value = numbers(p.value, "%.9g");
  if (!has_sigma(p)) return value;
  return {TomlTable{{"value", std::move(value)}, {"sigma", numbers(p.sigma, "%.3g")}}};
}

void add_values(TomlDocument& document, TomlTable& table,
                const std::vector<FittedParameter>& parameters) {
  for (const FittedParameter& p : parameters) document.set(table, p.key, value_of(p));
}

void add_effect(TomlDocument& document, const FoundEffect& effect, const std::string& table_name,
                bool with_initial_states) {
  if (!effect.explanation.empty()) document.comment(effect.explanation);
  document.comment("Probability " + printed("%.3f", effect.probability) + ".");
  for (const std::string& other : effect.indistinguishable_from) {
    document.comment("The recordings do not distinguish it from " + other + ".");
  }
  TomlTable& table = document.append(table_name);
  document.set(table, "kind", {effect.kind});
  for (const auto& [key, value] : effect.texts) document.set(table, key, {value});
  if (table_name == "effect") {
    // Effects on light have no prior, so their errors are written as a comment.
    for (const FittedParameter& p : effect.parameters) {
      if (p.key == "index" && p.value.size() > 1) {
        // The first of several equally good places is used.
        const std::vector<double> others(p.value.begin() + 1, p.value.end());
        document.set(table, p.key, numbers({p.value.front()}, "%.9g"),
                     "or as well " + toml_value(numbers(others, "%.9g")));
        continue;
      }
      document.set(table, p.key, numbers(p.value, "%.9g"),
                   has_sigma(p) ? "± " + toml_value(numbers(p.sigma, "%.3g")) : "");
    }
  } else {
    add_values(document, table, effect.parameters);
  }
  if (with_initial_states) add_values(document, table, effect.initial_states);
}

void add_unnamed(TomlDocument& document, const FoundEffect& effect, bool with_initial_states) {
  document.comment("Also fitted, but not significant: " + effect.kind + ".");
  TomlTable& table = document.append("disturbance");
  document.set(table, "kind", {effect.kind});
  add_values(document, table, effect.parameters);
  if (with_initial_states) add_values(document, table, effect.initial_states);
}

void add_empirical(TomlDocument& document, const EmpiricalTorque& torque) {
  document.comment("A torque that depends on " + torque.variable +
                   " but on no known law; it is described by a fitted function.");
  if (!torque.formula.empty()) document.comment(torque.formula);
  if (!torque.looks_like.empty()) document.comment("Looks like " + torque.looks_like + ".");
  if (torque.parameters.empty()) return;
  TomlTable& table = document.append("disturbance");
  document.set(table, "kind", {std::string("empirical_torque")});
  for (const auto& [key, value] : torque.shape) {
    SettingsNode shape = parse_toml("value = " + value, "shape");
    document.set(table, key, std::move(std::get<TomlTable>(shape.value).at("value")));
  }
  add_values(document, table, torque.parameters);
}

void add_replay(TomlDocument& document, const Replay& replay, const std::filesystem::path& folder) {
  const auto& q = replay.initial_attitude;
  const Vec3& w = replay.initial_rate_rad_s;
  document.comment("Propagates the first recording from its fitted initial state.");
  TomlTable& run = document.table("propagate");
  const auto set = [&](const char* key, const std::vector<double>& values, const char* format) {
    document.set(run, key, numbers(values, format));
  };
  set("duration_s", {replay.duration_s}, "%.9g");
  set("output_rate_Hz", {replay.output_rate_Hz}, "%.6g");
  set("initial_attitude", {q[0], q[1], q[2], q[3]}, "%.12g");
  if (replay.initial_turns != 0.0) set("initial_turns", {replay.initial_turns}, "%.0f");
  set("initial_rate_rad_s", {w.x(), w.y(), w.z()}, "%.12g");
  if (replay.initial_time_s != 0.0) set("initial_time_s", {replay.initial_time_s}, "%.12g");
  if (const auto& place = replay.initial_place_m_m_s) {
    set("initial_position_m", {(*place)[0], (*place)[1]}, "%.12g");
    set("initial_velocity_m_s", {(*place)[2], (*place)[3]}, "%.12g");
  }
  if (replay.initial_charge_C != 0.0) {
    set("initial_charge_Ah", {replay.initial_charge_C / 3600.0}, "%.9g");
  }
  if (!replay.has_commands) return;
  const auto path = std::filesystem::absolute(replay.recording);
  const auto relative = path.lexically_proximate(std::filesystem::absolute(folder));
  document.set(run, "commands", {relative.generic_string()});
}

// Replaces an uncertain value of the nominal model by the fitted one, which may have another unit;
// the old value remains as a comment. Returns false if the document lacks the key.
bool refine(TomlDocument& document, const FittedParameter& p) {
  const size_t dot = p.key.rfind('.');
  if (dot == std::string::npos) return false;
  auto* holder = const_cast<SettingsNode*>(find_setting(document.root, p.key.substr(0, dot)));
  auto* table = holder == nullptr ? nullptr : std::get_if<TomlTable>(&holder->value);
  if (table == nullptr) return false;
  const std::string key = p.key.substr(dot + 1);
  const KeyUnit wanted = unit_of_key(key);
  for (const auto& [written, value] : *table) {
    const KeyUnit unit = unit_of_key(written);
    if (unit.stem != wanted.stem || unit.dimension != wanted.dimension) continue;
    document.comment("before the fit: " + written + " = " + toml_value(value));
    document.replace(*table, std::string(written), key, value_of(p));
    return true;
  }
  return false;
}

}  // namespace

std::string improved_experiment(TomlDocument document, const Diagnosis& diagnosis,
                                const std::filesystem::path& folder) {
  // An experiment with [propagate] has an initial state.
  const std::optional<Replay> replay =
      std::get<TomlTable>(document.root.value).contains("propagate") ? std::nullopt
                                                                     : diagnosis.replay;
  document.add_to_head("Written by photorque diagnose: " + diagnosis.sentence);
  document.add_to_head(
      "The experiment with its values and comments (blank lines and line breaks may differ); the "
      "effects found are at the end of each table.");
  std::vector<FittedParameter> others;
  for (const FittedParameter& p : diagnosis.priors_refined) {
    if (!refine(document, p)) others.push_back(p);
  }
  for (const FoundEffect& effect : diagnosis.effects) {
    add_effect(document, effect, effect.table.empty() ? diagnosis.effect_table : effect.table,
               replay.has_value());
  }
  for (const FoundEffect& effect : diagnosis.unnamed) {
    add_unnamed(document, effect, replay.has_value());
  }
  for (const EmpiricalTorque& torque : diagnosis.empirical) add_empirical(document, torque);
  if (replay) add_replay(document, *replay, folder);
  if (!others.empty()) {
    document.comment("Uncertain numbers of the nominal model, with the errors after the fit:");
  }
  for (const FittedParameter& p : others) {
    document.comment("  " + p.key + " = " + toml_value(value_of(p)));
  }
  return document.text();
}

}  // namespace photorque
