// The cells lie under a glass: light counts T(θ)/T(0), T by Fresnel. refractive_index > 1.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::angular_response {

LightEffectKind kind() {
  const EffectParameter index = {.key = "refractive_index",
                                 .neutral = 1.0,
                                 .scale = 0.7,
                                 .lowest = 0.0,
                                 .highest = 1.0,
                                 .form = EffectParameter::Form::slant};
  return {.name = "angular_response",
          .explanation = "a glass over the cells lets less light in the more it slants",
          .parameters = {index},
          .in_scans = false,
          .act = [index](LightState& state, size_t, std::span<const double> x) {
            state.glass_index = value_of(index, x[0]);
          }};
}

}  // namespace photorque::kinds::angular_response
