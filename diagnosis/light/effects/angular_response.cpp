// The cells lie under a glass: light counts T(θ)/T(0), T by Fresnel. refractive_index > 1.
#include "diagnosis/light/effects/kind.h"

#include <algorithm>
#include <cmath>

namespace photorque {

LightEffectKind angular_response_kind() {
  return {.name = "angular_response",
          .explanation = "a glass over the cells lets less light in the more it slants",
          .parameters =
              {// Fresnel reflection grows with the square of n − 1, so that is what is fitted.
               {.key = "refractive_index",
                .neutral = 1.0,
                .scale = 0.25,
                .lowest = 0.0,
                .highest = 9.0,
                .form = EffectParameter::Form::root}},
          .in_scans = false,
          .act = [](LightState& state, size_t, std::span<const double> x) {
            state.glass_index = 1.0 + std::sqrt(std::max(0.0, x[0]));
          }};
}

}  // namespace photorque
