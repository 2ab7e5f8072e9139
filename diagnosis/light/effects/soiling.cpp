// Light that enters every cell times `factor`, 0 to 1. A scan does not see it.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::soiling {

LightEffectKind kind() {
  return {.name = "soiling",
          .explanation = "dirt on the cells takes the same fraction of the light from all of them",
          .parameters =
              {{.key = "factor", .neutral = 1.0, .scale = 0.1, .lowest = -1.0, .highest = 0.0}},
          .in_scans = false,
          .act = [](LightState& state, size_t, std::span<const double> x) {
            state.soiling *= 1.0 + x[0];
          }};
}

}  // namespace photorque::kinds::soiling
