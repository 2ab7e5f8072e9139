// The photocurrent of a cell times `factor`, 0 to 1. A scan does not see it.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::cell_degraded {

LightEffectKind kind() {
  return {.name = "cell_degraded",
          .explanation = "a cell turns less of its light into current than the others",
          .index = LightEffectKind::Index::cell,
          .parameters =
              {{.key = "factor", .neutral = 1.0, .scale = 0.2, .lowest = -1.0, .highest = 0.0}},
          .in_scans = false,
          .act = [](LightState& state, size_t index, std::span<const double> x) {
            state.cell_current[index] *= 1.0 + x[0];
          }};
}

}  // namespace photorque::kinds::cell_degraded
