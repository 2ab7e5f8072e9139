// A string carries no current.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::string_open {

LightEffectKind kind() {
  return {.name = "string_open",
          .explanation = "a string of cells is interrupted",
          .index = LightEffectKind::Index::string,
          .parameters = {},
          .in_scans = false,
          .in_circuit = true,
          .act = [](LightState& state, size_t index, std::span<const double>) {
            state.string_open[index] = true;
          }};
}

}  // namespace photorque::kinds::string_open
