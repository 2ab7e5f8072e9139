// The same as interreflection, from a wall that mirrors.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::interreflection_specular {

LightEffectKind kind() {
  return {.name = "interreflection",
          .explanation = "a wall that is assumed black mirrors light",
          .index = LightEffectKind::Index::wall,
          .parameters = {{.key = "specular", .scale = 0.3, .lowest = 0.0, .highest = 1.0}},
          .act = [](LightState& state, size_t index, std::span<const double> x) {
            state.walls.push_back({index, 0.0, x[0]});
          }};
}

}  // namespace photorque::kinds::interreflection_specular
