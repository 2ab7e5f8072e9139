// The tracker stands at a maximum that is not the highest from one instant to another,
// interval_s[2], of one recording (counted from 0). At which of them, every reading says for
// itself: as the platform turns, maxima change places and vanish.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::tracker_trapped {

LightEffectKind kind() {
  return {.name = "tracker_trapped",
          .explanation = "the tracker stands on a maximum of the power that is not the highest",
          .parameters = {{.key = "interval_s",
                          .count = 2,
                          .scale = 100.0,
                          .is_strength = false,
                          .is_fitted = false},
                         {.key = "recording", .is_strength = false, .is_fitted = false}},
          .in_scans = false,
          .in_sweeps = false,
          .in_circuit = true,
          .scan = LightEffectKind::Scan::trapped,
          .act = [](LightState& state, size_t, std::span<const double> x) {
            state.trapped.push_back({x[0], x[1], static_cast<int>(x[2])});
          }};
}

}  // namespace photorque::kinds::tracker_trapped
