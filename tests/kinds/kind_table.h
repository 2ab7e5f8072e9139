// The registry's row of every kind of disturbance, as the table of docs/disturbances.md.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "attitude/disturbances/kind.h"

namespace photorque {

inline std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// "`offset_m` 5e-06 each; …": the prior widths, SI.
inline std::string widths_text(const Parametrisation& p) {
  std::string text;
  for (const EffectKey& key : p.keys) {
    if (key.is_fixed) continue;
    text += (text.empty() ? "" : ", ") + ("`" + key.key + "` " + number_text(key.scale));
    if (key.times_inertia) text += " of the mean inertia";
    if (key.start.size() > 1) text += " each";
    if (key.lowest == 0.0) text += " (≥ 0)";
  }
  return text.empty() ? "acts or not" : text;
}

inline std::string screening_text(const Screening& screening) {
  if (screening.of_experiment != nullptr) return screening.widths;
  if (screening.parametrisations.empty()) return "no: " + screening.reason_against;
  std::string text;
  for (const Parametrisation& p : screening.parametrisations) {
    text += (text.empty() ? "" : "; or ") + widths_text(p);
    if (p.of_free_bodies) text += " of a free body";
  }
  constexpr const char* scans[] = {"", "its instant is scanned", "its frequency is scanned",
                                   "its frequency and axis are scanned"};
  if (screening.scan != Scan::nothing) text += "; " + std::string(scans[int(screening.scan)]);
  constexpr const char* needs[] = {
      "",
      "commanded torques or forces",
      "a battery current",
      "a magnetic field",
      "weight on a bearing",
      "a bearing",
      "an air bearing",
      "a bearing, or a free body's attitude in a laboratory of stated latitude",
      "an air bearing, or a free body's attitude in a laboratory of stated latitude",
      "the measured speed of a wheel",
      "the measured current of lamps, and that it changes",
      "a planar platform",
      "commanded forces"};
  if (screening.needs != Requirement::none) {
    text += "; needs " + std::string(needs[int(screening.needs)]);
  }
  return text;
}

inline std::string kind_row(const DisturbanceKind& kind) {
  const bool ranked = kind.budget.reason_against.empty();
  return "| `" + kind.name + "` | " + kind.summary + " | " + screening_text(kind.screening) +
         " | " + (ranked ? "yes" : "no: " + kind.budget.reason_against) + " |\n";
}

inline std::string kind_table(const std::vector<DisturbanceKind>& kinds) {
  std::string text =
      "| `kind` | in one sentence | `diagnose` screens it, expecting (SI) | `budget` ranks it |\n"
      "|---|---|---|---|\n";
  for (const DisturbanceKind& kind : kinds) text += kind_row(kind);
  return text;
}

}  // namespace photorque
