// Effects on the array: light that enters its cells, its circuit, its tracker.
#include "scenes/effects/kind.h"

namespace photorque {

std::vector<LightEffectKind> array_effect_kinds() {
  using Index = LightEffectKind::Index;
  using Numbers = std::span<const double>;
  // The light is multiplied by T(θ)/T(0), where T is Fresnel's transmittance.
  const EffectParameter refractive_index = {.key = "refractive_index",
                                            .meaning = "refractive index of the glass",
                                            .neutral = 1.0,
                                            .scale = 0.7,
                                            .lowest = 0.0,
                                            .highest = 1.0,
                                            .form = EffectParameter::Form::slant};
  return {
      {.name = "soiling",
       .explanation = "dirt absorbs the same fraction of the light of all cells",
       .parameters = {remaining_fraction("fraction of the light that still enters the cells", 0.1)},
       .in_scans = false,
       .act = multiplies(&LightState::soiling)},
      {.name = "angular_response",
       .explanation = "a glass over the cells reflects more of oblique light",
       .parameters = {refractive_index},
       .in_scans = false,
       .act = [refractive_index](
                  LightState& state, size_t,
                  Numbers x) { state.glass_index = value_of(refractive_index, x[0]); }},
      {.name = "cell_degraded",
       .explanation = "a cell converts less of its light into current than the others",
       .index = Index::cell,
       .parameters = {remaining_fraction("factor on the photocurrent of the cell", 0.2,
                                         {-0.1, -0.5})},
       .in_scans = false,
       .act = multiplies_one(&LightState::cell_current)},
      {.name = "cell_shaded",
       .explanation = "an object over a cell takes a fraction of its light",
       .index = Index::cell,
       .parameters = {remaining_fraction("fraction of the light that the cell receives", 0.2,
                                         {-0.1, -0.5})},
       .act = multiplies_one(&LightState::cell_light)},
      // The string carries no current.
      {.name = "string_open",
       .explanation = "a string of cells is interrupted",
       .index = Index::string,
       .parameters = {},
       .in_scans = false,
       .in_circuit = true,
       .act = [](LightState& state, size_t index, Numbers) { state.string_open[index] = true; }},
      // The cells of the diode give zero voltage.
      {.name = "bypass_shorted",
       .explanation = "a bypass diode is shorted and bypasses its cells",
       .index = Index::bypass,
       .parameters = {},
       .in_scans = false,
       .in_circuit = true,
       .act = [](LightState& state, size_t index, Numbers) { state.bypass_shorted[index] = true; }},
      {.name = "series_resistance",
       .explanation =
           "a resistance in series with the array, such as a bad contact or a long cable",
       .parameters = {from_zero("resistance_ohm", "resistance in series with the array", 0.2, 1e4)},
       .in_scans = false,
       .in_circuit = true,
       .act = adds_to(&LightState::series_ohm)},
      // A resistance across every cell, parallel to its shunt.
      {.name = "shunt",
       .explanation = "leakage across every cell beside the stated shunt",
       .parameters = {{.key = "resistance_ohm",
                       .meaning = "resistance across each cell, in parallel with the stated shunt",
                       .scale = 0.02,
                       .lowest = 0.0,
                       .highest = 1e3,
                       .form = EffectParameter::Form::reciprocal}},
       .in_scans = false,
       .in_circuit = true,
       .act = adds_to(&LightState::shunt_S)},
      // photocurrent_per_K is added to photocurrent_slope_per_K. voltage_V_per_K times the
      // temperature above reference is added to the voltage of every cell.
      {.name = "temperature_coefficient",
       .explanation = "the temperature coefficients of the cells differ from those stated",
       .parameters =
           {{.key = "photocurrent_per_K",
             .meaning = "addition to `photocurrent_slope_per_K` of the cells",
             .scale = 1e-3,
             .lowest = -0.05,
             .highest = 0.05},
            {.key = "voltage_V_per_K",
             .meaning =
                 "additional voltage of each cell per kelvin above its reference temperature",
             .scale = 1e-3,
             .lowest = -0.05,
             .highest = 0.05}},
       .in_scans = false,
       .in_circuit = true,
       .act =
           [](LightState& state, size_t, Numbers x) {
             state.photocurrent_per_K += x[0];
             state.voltage_V_per_K += x[1];
           }},
      // Between two instants of one recording (counted from 0). The local maximum of the tracker is
      // recomputed at every reading, because maxima move and vanish when the platform rotates.
      {.name = "tracker_trapped",
       .explanation = "the tracker holds a local maximum of the power",
       .parameters = {{.key = "interval_s",
                       .meaning = "start and end of the interval at the local maximum",
                       .count = 2,
                       .scale = 100.0,
                       .is_strength = false,
                       .is_fitted = false},
                      {.key = "recording",
                       .meaning = "number of the recording, from 0",
                       .is_strength = false,
                       .is_fitted = false}},
       .in_scans = false,
       .in_sweeps = false,
       .in_circuit = true,
       .scan = LightEffectKind::Scan::trapped,
       .act =
           [](LightState& state, size_t, Numbers x) {
             state.trapped.push_back({x[0], x[1], static_cast<int>(x[2])});
           }},
  };
}

}  // namespace photorque
