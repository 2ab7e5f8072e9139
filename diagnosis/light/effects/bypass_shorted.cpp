// The cells of a bypass diode give no voltage.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::bypass_shorted {

LightEffectKind kind() {
  return {.name = "bypass_shorted",
          .explanation = "a bypass diode is shorted and takes its cells away",
          .index = LightEffectKind::Index::bypass,
          .parameters = {},
          .in_scans = false,
          .in_circuit = true,
          .act = [](LightState& state, size_t index, std::span<const double>) {
            state.bypass_shorted[index] = true;
          }};
}

}  // namespace photorque::kinds::bypass_shorted
