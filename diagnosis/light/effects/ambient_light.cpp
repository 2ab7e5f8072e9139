// Light of the room, the same at every place of the receiver and at every attitude. irradiance_W_m2
// ≥ 0.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::ambient_light {

LightEffectKind kind() {
  return {.name = "ambient_light",
          .explanation = "light of the room is added to that of the lamps",
          .parameters = {{.key = "irradiance_W_m2", .scale = 20.0, .lowest = 0.0, .highest = 1e5}},
          .act = [](LightState& state, size_t, std::span<const double> x) {
            state.ambient_W_m2 += x[0];
          }};
}

}  // namespace photorque::kinds::ambient_light
