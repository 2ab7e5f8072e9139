// A part of the scene that is assumed black throws a share of its light back. diffuse or specular,
// 0 to 1.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::interreflection {

LightEffectKind kind() {
  return {.name = "interreflection",
          .explanation = "a wall that is assumed black throws light back",
          .index = LightEffectKind::Index::wall,
          .parameters = {{.key = "diffuse", .scale = 0.3, .lowest = 0.0, .highest = 1.0}},
          .act = [](LightState& state, size_t index, std::span<const double> x) {
            state.walls.push_back({index, x[0], 0.0});
          }};
}

}  // namespace photorque::kinds::interreflection
