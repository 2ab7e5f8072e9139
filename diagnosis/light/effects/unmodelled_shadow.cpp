// Something opaque, fixed in the lab or on the body, hides lamps from part of the receiver: the
// thin box that does it. Its thickness does not show. opacity (1: opaque), centre_m[3] and
// size_m[2], lab or body axes.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::unmodelled_shadow {

LightEffectKind kind() {
  return {.name = "unmodelled_shadow",
          .explanation =
              "something opaque that is not in the model hides lamps from part of the receiver",
          .index = LightEffectKind::Index::frame,
          .parameters =
              {{.key = "opacity", .scale = 0.5, .lowest = 0.0, .highest = 1.0},
               {.key = "centre_m", .count = 3, .scale = 0.02, .is_strength = false, .step = 5e-4},
               {.key = "size_m",
                .count = 2,
                .scale = 0.02,
                .lowest = 1e-4,
                .highest = 2.0,
                .is_strength = false,
                .step = 5e-4}},
          .scan = LightEffectKind::Scan::shadow,
          .act = [](LightState& state, size_t frame, std::span<const double> x) {
            constexpr double half_thickness_m = 1e-3;
            const Vec3 centre(x[1], x[2], x[3]), half(0.5 * x[4], 0.5 * x[5], half_thickness_m);
            state.boxes.push_back({frame == 1, centre - half, centre + half, x[0]});
          }};
}

}  // namespace photorque::kinds::unmodelled_shadow
