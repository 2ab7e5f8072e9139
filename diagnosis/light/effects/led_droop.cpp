// All lamps fade while they warm up: power × 1 − depth (1 − e^(−t/τ)), t since they were switched
// on (t_s = 0). depth, time_constant_s.
#include "diagnosis/light/effects/kind.h"

namespace photorque::kinds::led_droop {

LightEffectKind kind() {
  return {.name = "led_droop",
          .explanation = "the lamps lose power while they warm up",
          .parameters = {{.key = "depth", .scale = 0.1, .lowest = 0.0, .highest = 1.0},
                         {.key = "time_constant_s",
                          .scale = 300.0,
                          .lowest = 1.0,
                          .highest = 1e6,
                          .is_strength = false,
                          .starts = {10, 30, 100, 300, 1000, 3000, 10000}}},
          .in_scans = false,
          .in_sweeps = false,
          .act = [](LightState& state, size_t, std::span<const double> x) {
            state.droop_depth = x[0];
            state.droop_time_s = x[1];
          }};
}

}  // namespace photorque::kinds::led_droop
