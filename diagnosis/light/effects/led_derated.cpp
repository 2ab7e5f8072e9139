// One LED gives a share of its power. factor: 0 to 1.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::led_derated {

LightEffectKind kind() {
  return {.name = "led_derated",
          .explanation = "an LED gives less than its stated power",
          .index = LightEffectKind::Index::lamp,
          .parameters =
              {{.key = "factor", .neutral = 1.0, .scale = 0.3, .lowest = -1.0, .highest = 0.0}},
          .act = [](LightState& state, size_t index, std::span<const double> x) {
            state.lamp_power[index] *= 1.0 + x[0];
          }};
}

}  // namespace photorque::kinds::led_derated
