// A resistance in series with the whole array. resistance_ohm ≥ 0.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::series_resistance {

LightEffectKind kind() {
  return {
      .name = "series_resistance",
      .explanation = "a resistance in series with the array, such as a bad contact or a long cable",
      .parameters = {{.key = "resistance_ohm", .scale = 0.2, .lowest = 0.0, .highest = 1e4}},
      .in_scans = false,
      .in_circuit = true,
      .act = [](LightState& state, size_t, std::span<const double> x) {
        state.series_ohm += x[0];
      }};
}

}  // namespace photorque::kinds::series_resistance
