// The body is turned against what is recorded by a rotation vector about lab x and y. bias_deg[2].
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::attitude_bias {

LightEffectKind kind() {
  return {.name = "attitude_bias",
          .explanation = "the platform stands turned against its recorded attitude",
          .parameters =
              {{.key = "bias_deg", .count = 2, .scale = 0.02, .lowest = -0.3, .highest = 0.3}},
          .act = [](LightState& state, size_t, std::span<const double> x) {
            state.attitude_bias_rad += Vec2(x[0], x[1]);
          }};
}

}  // namespace photorque::kinds::attitude_bias
