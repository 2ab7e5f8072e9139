// One LED looks elsewhere: its axis d becomes d + tan a₁ e₁ + tan a₂ e₂, e being lab x and y made
// perpendicular to d. angles_deg[2].
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::led_aim {

LightEffectKind kind() {
  return {.name = "led_aim",
          .explanation = "an LED is turned away from where it is stated to look",
          .index = LightEffectKind::Index::lamp,
          .parameters = {{.key = "angles_deg",
                          .count = 2,
                          .scale = 0.03,
                          .lowest = -0.12,
                          .highest = 0.12,
                          .form = EffectParameter::Form::tangent}},
          .act = [](LightState& state, size_t index, std::span<const double> x) {
            state.lamp_aim[index] += Vec2(x[0], x[1]);
          }};
}

}  // namespace photorque::kinds::led_aim
