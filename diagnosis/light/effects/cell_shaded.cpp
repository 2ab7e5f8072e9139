// The light over the rectangle of a cell times `factor`, 0 to 1. A scan sees it.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::cell_shaded {

LightEffectKind kind() {
  return {.name = "cell_shaded",
          .explanation = "something over a cell takes a fraction of its light",
          .index = LightEffectKind::Index::cell,
          .parameters =
              {{.key = "factor", .neutral = 1.0, .scale = 0.2, .lowest = -1.0, .highest = 0.0}},
          .act = [](LightState& state, size_t index, std::span<const double> x) {
            state.cell_light[index] *= 1.0 + x[0];
          }};
}

}  // namespace photorque::kinds::cell_shaded
