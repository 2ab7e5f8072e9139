// The cells follow their temperature otherwise than stated: photocurrent_per_K [1/K] is added to
// photocurrent_slope_per_K, voltage_V_per_K to the voltage of every cell per kelvin above its
// reference temperature.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::temperature_coefficient {

LightEffectKind kind() {
  return {
      .name = "temperature_coefficient",
      .explanation = "the cells follow their temperature otherwise than stated",
      .parameters = {{.key = "photocurrent_per_K", .scale = 1e-3, .lowest = -0.05, .highest = 0.05},
                     {.key = "voltage_V_per_K", .scale = 1e-3, .lowest = -0.05, .highest = 0.05}},
      .in_scans = false,
      .in_circuit = true,
      .act = [](LightState& state, size_t, std::span<const double> x) {
        state.photocurrent_per_K += x[0];
        state.voltage_V_per_K += x[1];
      }};
}

}  // namespace photorque::kinds::temperature_coefficient
