// The angular width of all beams times `scale`, with the same power.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::beam_divergence {

LightEffectKind kind() {
  return {.name = "beam_divergence",
          .explanation = "all beams are wider or narrower than stated",
          .parameters =
              {{.key = "scale", .neutral = 1.0, .scale = 0.1, .lowest = -0.7, .highest = 2.0}},
          .act = [](LightState& state, size_t, std::span<const double> x) {
            state.divergence *= 1.0 + x[0];
          }};
}

}  // namespace photorque::kinds::beam_divergence
