// All lamps stand elsewhere by offset_m[3], lab, with their axes kept.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::source_shift {

LightEffectKind kind() {
  return {.name = "source_shift",
          .explanation = "the lamps stand beside where they are stated to stand",
          .parameters =
              {{.key = "offset_m", .count = 3, .scale = 0.01, .lowest = -0.1, .highest = 0.1}},
          .act = [](LightState& state, size_t, std::span<const double> x) {
            state.shift_m += Vec3(x[0], x[1], x[2]);
          }};
}

}  // namespace photorque::kinds::source_shift
