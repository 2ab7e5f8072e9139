#include "attitude/disturbances/screening.h"

#include "core/text/format.h"

namespace photorque {
namespace {

// The prior widths as text, "`offset_m` 5e-06 each; …", SI.
std::string widths_text(const Parametrisation& p) {
  std::string text;
  for (const EffectKey& key : p.keys) {
    if (key.is_fixed) continue;
    text += (text.empty() ? "" : ", ") + ("`" + key.key + "` " + printed("%.4g", key.scale));
    if (key.times_inertia) text += " of the mean inertia";
    if (key.start.size() > 1) text += " each";
    if (key.lowest == 0.0) text += " (≥ 0)";
  }
  return text.empty() ? "presence only" : text;
}

}  // namespace

std::string screening_text(const Screening& screening) {
  if (screening.of_experiment == nullptr && screening.parametrisations.empty()) {
    return "Not tested by `diagnose`: " + screening.reason_against;
  }
  std::string text;
  for (const Parametrisation& p : screening.parametrisations) {
    text += (text.empty() ? "" : " or ") + widths_text(p);
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
  return "Tested by `diagnose`: " + (screening.of_experiment != nullptr ? screening.widths : text);
}

}  // namespace photorque
