// All lamps give `factor` times their stated power.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::source_power {

LightEffectKind kind() {
  return {.name = "source_power",
          .explanation = "all lamps give more or less than their stated power",
          .parameters =
              {{.key = "factor", .neutral = 1.0, .scale = 0.1, .lowest = -0.95, .highest = 4.0}},
          .act = [](LightState& state, size_t, std::span<const double> x) {
            state.power *= 1.0 + x[0];
          }};
}

}  // namespace photorque::kinds::source_power
