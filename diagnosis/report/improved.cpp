#include "diagnosis/report/improved.h"

#include <cmath>
#include <cstdio>
#include <regex>

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
  const std::string value = array_text(p.value, "%.9g");
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

std::string effect_text(const FoundEffect& effect) {
  std::string text = "\n";
  if (!effect.explanation.empty()) text += comment(effect.explanation);
  text += comment("Probability " + print("%.3f", effect.probability) + ".");
  for (const std::string& other : effect.indistinguishable_from) {
    text += comment("The recordings cannot tell it from " + other + ".");
  }
  text += "[[disturbance]]\nkind = \"" + effect.kind + "\"\n";
  for (const FittedParameter& p : effect.parameters) text += p.key + " = " + value_text(p) + "\n";
  return text;
}

std::string unnamed_text(const FoundEffect& effect) {
  std::string text =
      "\n" + comment("Fitted beside the torque below, without being proved: " + effect.kind + ".");
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
  if (!replay.has_commands) return text;
  const auto path = std::filesystem::absolute(replay.recording);
  const auto relative = path.lexically_proximate(std::filesystem::absolute(folder));
  return text + "commands = '" + relative.generic_string() + "'\n";
}

}  // namespace

std::string improved_experiment(const std::string& text, const Diagnosis& diagnosis,
                                const std::filesystem::path& folder) {
  std::string improved = text;
  if (!improved.empty() && improved.back() != '\n') improved += '\n';
  improved += "\n" + comment("---- Added by the diagnosis: " + diagnosis.sentence);
  for (const FoundEffect& effect : diagnosis.effects) improved += effect_text(effect);
  for (const FoundEffect& effect : diagnosis.unnamed) improved += unnamed_text(effect);
  for (const EmpiricalTorque& torque : diagnosis.empirical) improved += empirical_text(torque);
  if (!diagnosis.priors_refined.empty()) {
    improved +=
        "\n" + comment("The same recordings narrow the uncertain numbers of the nominal model to:");
  }
  for (const FittedParameter& p : diagnosis.priors_refined) {
    improved += comment("  " + p.key + " = " + value_text(p));
  }
  static const std::regex propagates(R"((^|\n)\s*\[\s*propagate\s*[\].])");
  if (diagnosis.replay && !std::regex_search(text, propagates)) {
    improved += replay_text(*diagnosis.replay, folder);
  }
  return improved;
}

}  // namespace photorque
