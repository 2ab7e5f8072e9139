#include "diagnosis/improved.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <regex>

#include "core/settings/settings.h"

namespace photorque {
namespace {

std::string print(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string array_text(const std::vector<double>& values, const char* format) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + print(format, value);
  return values.size() == 1 ? text : "[" + text + "]";
}

// A sigma of 0 or an unknown one cannot stand beside fitted numbers: the value is then exact.
bool has_sigma(const FittedParameter& p) {
  bool any = false;
  for (const double s : p.sigma) {
    if (!std::isfinite(s) || s < 0.0) return false;
    any = any || s > 0.0;
  }
  return any && p.sigma.size() == p.value.size();
}

std::string value_text(const FittedParameter& p) {
  std::string value = array_text(p.value, "%.9g");
  if (!has_sigma(p)) return value;
  return "{ value = " + value + ", sigma = " + array_text(p.sigma, "%.3g") + " }";
}

std::string comment(const std::string& text) {
  std::string line = "# " + text;
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return line + "\n";
}

// Exact numbers, with their errors as a comment: of what acts on light there is no prior. Of places
// that explain as much the first is taken.
std::string plain_text(const FittedParameter& p) {
  if (p.key == "index" && p.value.size() > 1) {
    const std::vector<double> others(p.value.begin() + 1, p.value.end());
    return p.key + " = " + print("%.9g", p.value.front()) + "  # or as well " +
           array_text(others, "%.9g") + "\n";
  }
  std::string text = p.key + " = " + array_text(p.value, "%.9g");
  if (has_sigma(p)) text += "  # ± " + array_text(p.sigma, "%.3g");
  return text + "\n";
}

std::string begins_text(const FoundEffect& effect) {
  std::string text;
  for (const FittedParameter& p : effect.begins) text += p.key + " = " + value_text(p) + "\n";
  return text;
}

std::string effect_text(const FoundEffect& effect, const std::string& table) {
  std::string text = "\n";
  if (!effect.explanation.empty()) text += comment(effect.explanation);
  text += comment("Probability " + print("%.3f", effect.probability) + ".");
  for (const std::string& other : effect.indistinguishable_from) {
    text += comment("The recordings cannot tell it from " + other + ".");
  }
  text += "[[" + table + "]]\nkind = \"" + effect.kind + "\"\n";
  for (const auto& [key, value] : effect.texts) text += key + " = \"" + value + "\"\n";
  for (const FittedParameter& p : effect.parameters) {
    text += table == "effect" ? plain_text(p) : p.key + " = " + value_text(p) + "\n";
  }
  return text;
}

std::string unnamed_text(const FoundEffect& effect) {
  std::string text = "\n" + comment("Fitted beside, without being proved: " + effect.kind + ".");
  text += "[[disturbance]]\nkind = \"" + effect.kind + "\"\n";
  for (const FittedParameter& p : effect.parameters) text += p.key + " = " + value_text(p) + "\n";
  return text;
}

std::string empirical_text(const EmpiricalTorque& torque) {
  std::string text = "\n" + comment("A torque that depends on " + torque.variable +
                                    " and follows no law of the catalogue, fitted without one.");
  if (!torque.formula.empty()) text += comment(torque.formula);
  if (!torque.looks_like.empty()) text += comment("Looks like " + torque.looks_like + ".");
  if (torque.parameters.empty()) return text;
  text += "[[disturbance]]\nkind = \"empirical_torque\"\n";
  for (const auto& [key, value] : torque.shape) text += key + " = " + value + "\n";
  for (const FittedParameter& p : torque.parameters) text += p.key + " = " + value_text(p) + "\n";
  return text;
}

std::string replay_text(const Replay& replay, const std::filesystem::path& folder) {
  const auto& q = replay.initial_attitude;
  const Vec3& w = replay.initial_rate_rad_s;
  std::string text = "\n" + comment("Flies the first recording again, from its fitted start.");
  text += "[propagate]\nduration_s = " + print("%.9g", replay.duration_s) + "\n";
  text += "output_rate_Hz = " + print("%.6g", replay.output_rate_Hz) + "\n";
  text += "initial_attitude = " + array_text({q[0], q[1], q[2], q[3]}, "%.12g") + "\n";
  text += "initial_rate_rad_s = " + array_text({w.x(), w.y(), w.z()}, "%.12g") + "\n";
  if (replay.initial_time_s != 0.0) {
    text += "initial_time_s = " + print("%.12g", replay.initial_time_s) + "\n";
  }
  if (const auto& place = replay.initial_place_m_m_s) {
    text += "initial_position_m = " + array_text({(*place)[0], (*place)[1]}, "%.12g") + "\n" +
            "initial_velocity_m_s = " + array_text({(*place)[2], (*place)[3]}, "%.12g") + "\n";
  }
  if (replay.initial_charge_C != 0.0) {
    text += "initial_charge_Ah = " + print("%.9g", replay.initial_charge_C / 3600.0) + "\n";
  }
  if (!replay.has_commands) return text;
  const auto path = std::filesystem::absolute(replay.recording);
  const auto relative = path.lexically_proximate(std::filesystem::absolute(folder));
  return text + "commands = '" + relative.generic_string() + "'\n";
}

// Where the value that begins at `from` ends: the end of its line, a comment, or, of an array or a
// table, its last bracket.
size_t end_of_value(const std::string& text, size_t from) {
  int depth = 0;
  for (size_t i = from; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = std::min(text.find(c, i + 1), text.size());
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      if (--depth == 0) return i + 1;
    } else if (depth == 0 && (c == '\n' || c == '#')) {
      return i;
    } else if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
    }
  }
  return text.size();
}

// A key by the table that it stands in: "source[1].power_W", "attitude.tilt_deg".
struct KeyPlace {
  std::string table;  // "array.cell_override"
  std::optional<size_t> number;
  std::string key;
};
std::optional<KeyPlace> place_of(const std::string& path) {
  static const std::regex place(R"(([A-Za-z0-9_.-]+?)(?:\[([0-9]+)\])?\.([A-Za-z0-9_-]+))");
  std::smatch name;
  if (!std::regex_match(path, name, place)) return std::nullopt;
  KeyPlace at{name[1].str(), std::nullopt, name[3].str()};
  if (name[2].matched) at.number = std::stoul(name[2].str());
  return at;
}

// Where a table begins.
std::regex header_of(const KeyPlace& place) {
  const std::string name =
      std::regex_replace(place.table, std::regex(R"(\.)"), R"([ \t]*\.[ \t]*)");
  const std::string open = place.number ? R"(\[\[)" : R"(\[)",
                    close = place.number ? R"(\]\])" : R"(\])";
  return std::regex(R"((?:^|\n)[ \t]*)" + open + R"([ \t]*)" + name + R"([ \t]*)" + close);
}

// The assignment of a key, perhaps in another unit, within its table; none where the file says it
// in another way.
struct Assignment {
  size_t begin = 0, value = 0, end = 0;
};
std::optional<Assignment> find_assignment(const std::string& text, const KeyPlace& place) {
  static const std::regex begin_of_line(R"([ \t]*(\[|([A-Za-z0-9_-]+)[ \t]*=))");
  const std::regex header = header_of(place);
  auto table = std::sregex_iterator(text.begin(), text.end(), header);
  for (size_t i = 0; i < place.number.value_or(0) && table != std::sregex_iterator(); ++i) ++table;
  if (table == std::sregex_iterator()) return std::nullopt;
  const KeyUnit wanted = unit_of_key(place.key);
  auto line = static_cast<size_t>(table->position() + table->length());
  while ((line = text.find('\n', line)) != std::string::npos) {
    ++line;
    std::smatch found;
    const auto from = text.begin() + static_cast<std::ptrdiff_t>(line);
    if (!std::regex_search(from, text.end(), found, begin_of_line,
                           std::regex_constants::match_continuous)) {
      continue;
    }
    if (found[1].str() == "[") return std::nullopt;
    const size_t value = line + static_cast<size_t>(found.length());
    const size_t end = end_of_value(text, value);
    const KeyUnit unit = unit_of_key(found[2].str());
    if (unit.stem == wanted.stem && unit.dimension == wanted.dimension) {
      return Assignment{line, value, end};
    }
    line = end;
  }
  return std::nullopt;
}

// What the fit says about uncertain numbers of the nominal model, in their places; as they were
// written they stay as comments. What is not found goes to `others`.
std::string with_refined(std::string text, const std::vector<FittedParameter>& refined,
                         std::vector<FittedParameter>& others) {
  for (const FittedParameter& p : refined) {
    const std::optional<KeyPlace> place = place_of(p.key);
    std::optional<Assignment> at;
    if (place) at = find_assignment(text, *place);
    if (!at) {
      others.push_back(p);
      continue;
    }
    const std::string before = text.substr(at->begin, at->end - at->begin);
    text.replace(at->begin, at->end - at->begin,
                 comment("before the fit: " + before) + place->key + " = " + value_text(p));
  }
  return text;
}

// Where the schema lies is said relative to the experiment, and this one lies elsewhere.
std::string without_schema(const std::string& text) {
  return text.starts_with("#:schema ") ? text.substr(text.find('\n') + 1) : text;
}

}  // namespace

std::string improved_experiment(const std::string& text, const Diagnosis& diagnosis,
                                const std::filesystem::path& folder) {
  // An experiment that propagates has a start of its own.
  static const std::regex propagates(R"((^|\n)\s*\[\s*propagate\s*[\].])");
  const std::optional<Replay> replay =
      std::regex_search(text, propagates) ? std::nullopt : diagnosis.replay;
  std::vector<FittedParameter> others;
  std::string improved = with_refined(without_schema(text), diagnosis.priors_refined, others);
  if (!improved.empty() && improved.back() != '\n') improved += '\n';
  improved += "\n" + comment("---- Added by the diagnosis: " + diagnosis.sentence);
  for (const FoundEffect& effect : diagnosis.effects) {
    improved += effect_text(effect, effect.table.empty() ? diagnosis.effect_table : effect.table);
    if (replay) improved += begins_text(effect);
  }
  for (const FoundEffect& effect : diagnosis.unnamed) {
    improved += unnamed_text(effect);
    if (replay) improved += begins_text(effect);
  }
  for (const EmpiricalTorque& torque : diagnosis.empirical) improved += empirical_text(torque);
  if (!others.empty()) {
    improved +=
        "\n" + comment("The same recordings narrow the uncertain numbers of the nominal model to:");
  }
  for (const FittedParameter& p : others) {
    improved += comment("  " + p.key + " = " + value_text(p));
  }
  if (replay) improved += replay_text(*replay, folder);
  return improved;
}

}  // namespace photorque
