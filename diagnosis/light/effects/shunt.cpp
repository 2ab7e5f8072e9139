// A resistance across every cell, beside the shunt that it has. resistance_ohm > 0.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::shunt {

LightEffectKind kind() {
  return {
      .name = "shunt",
      .explanation = "leakage across every cell beside the stated shunt",
      .parameters = {{.key = "resistance_ohm",
                      .scale = 0.02,
                      .lowest = 0.0,
                      .highest = 1e3,
                      .form = EffectParameter::Form::reciprocal}},
      .in_scans = false,
      .in_circuit = true,
      .act = [](LightState& state, size_t, std::span<const double> x) { state.shunt_S += x[0]; }};
}

}  // namespace photorque::kinds::shunt
