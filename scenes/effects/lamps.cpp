// Effects on lamps: emitted power, position and direction.
#include "scenes/effects/kind.h"

namespace photorque {

std::vector<LightEffectKind> lamp_effect_kinds() {
  using Index = LightEffectKind::Index;
  using Numbers = std::span<const double>;
  return {
      {.name = "led_derated",
       .explanation = "an LED gives less than its stated power",
       .index = Index::lamp,
       .parameters = {remaining_fraction("fraction of the stated power that the LED emits", 0.3)},
       .is_traced = true,
       .act = multiplies_one(&LightState::lamp_power)},
      // The axis d becomes d + tan a₁ e₁ + tan a₂ e₂; e₁ and e₂ are lab x and y, made perpendicular
      // to d.
      {.name = "led_aim",
       .explanation = "the beam of an LED is rotated from its stated direction",
       .index = Index::lamp,
       .parameters = {{.key = "angles_deg",
                       .meaning = "rotations of the beam axis towards lab x and towards lab y",
                       .count = 2,
                       .scale = 0.03,
                       .lowest = -0.12,
                       .highest = 0.12,
                       .form = EffectParameter::Form::tangent}},
       .is_traced = true,
       .act = [](LightState& state, size_t index,
                 Numbers x) { state.lamp_aim[index] += Vec2(x[0], x[1]); }},
      // Multiplies the angular width of all beams by `scale`; the power is unchanged.
      {.name = "beam_divergence",
       .explanation = "all beams are wider or narrower than stated",
       .parameters = {{.key = "scale",
                       .meaning = "factor on the angular width of all beams",
                       .neutral = 1.0,
                       .scale = 0.1,
                       .lowest = -0.7,
                       .highest = 2.0}},
       .is_traced = true,
       .act = multiplies(&LightState::divergence)},
      // Displaces all lamps by offset_m, lab axes; their directions are unchanged.
      {.name = "source_shift",
       .explanation = "the lamps are displaced from their stated positions",
       .parameters = {{.key = "offset_m",
                       .meaning = "displacement of all lamps, lab axes",
                       .count = 3,
                       .scale = 0.01,
                       .lowest = -0.1,
                       .highest = 0.1}},
       .is_traced = true,
       .act = [](LightState& state, size_t,
                 Numbers x) { state.shift_m += Vec3(x[0], x[1], x[2]); }},
      {.name = "source_power",
       .explanation = "all lamps give more or less than their stated power",
       .parameters = {gain_factor("factor on the power of all lamps")},
       .is_traced = true,
       .act = multiplies(&LightState::power)},
      // Multiplies the power by 1 − depth (1 − e^(−t/τ)); t is the time since the lamps were
      // switched on (t_s = 0).
      {.name = "led_droop",
       .explanation = "the lamps lose power while they warm up",
       .parameters = {from_zero("depth", "fraction of their light that the lamps lose when warm",
                                0.1, 1.0),
                      {.key = "time_constant_s",
                       .meaning = "time constant of the loss",
                       .scale = 300.0,
                       .lowest = 1.0,
                       .highest = 1e6,
                       .is_strength = false,
                       .starts = {10, 30, 100, 300, 1000, 3000, 10000}}},
       .in_scans = false,
       .in_sweeps = false,
       .act =
           [](LightState& state, size_t, Numbers x) {
             state.droop_depth = x[0];
             state.droop_time_s = x[1];
           }},
  };
}

}  // namespace photorque
