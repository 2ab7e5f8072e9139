// The readings of a scan times `factor`.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::detector_gain {

LightEffectKind kind() {
  return {.name = "detector_gain",
          .explanation = "the photodiode reads too much or too little by one factor",
          .parameters =
              {{.key = "factor", .neutral = 1.0, .scale = 0.1, .lowest = -0.95, .highest = 4.0}},
          .in_sweeps = false,
          .in_runs = false,
          .act = [](LightState& state, size_t, std::span<const double> x) {
            state.detector_gain *= 1.0 + x[0];
          }};
}

}  // namespace photorque::kinds::detector_gain
