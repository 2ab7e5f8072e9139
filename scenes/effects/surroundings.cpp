// Effects between the lamps and the cells: additional light, shadows, walls, attitude, and the
// photodiode.
#include "scenes/effects/kind.h"

namespace photorque {

std::vector<LightEffectKind> surroundings_effect_kinds() {
  using Index = LightEffectKind::Index;
  using Numbers = std::span<const double>;
  return {
      // Uniform over the receiver and all attitudes.
      {.name = "ambient_light",
       .explanation = "light of the room is added to that of the lamps",
       .parameters = {from_zero("irradiance_W_m2", "irradiance of the light of the room", 20.0,
                                1e5)},
       .act = adds_to(&LightState::ambient_W_m2)},
      // A thin box, fixed in the lab or on the body; its thickness has no visible effect. opacity 1
      // is opaque.
      {.name = "unmodelled_shadow",
       .explanation = "an opaque object outside the model hides lamps from part of the receiver",
       .index = Index::frame,
       .parameters = {from_zero("opacity", "opacity of the object", 0.5, 1.0),
                      {.key = "centre_m",
                       .meaning = "centre of the object, in the axes of `axes`",
                       .count = 3,
                       .scale = 0.02,
                       .is_strength = false,
                       .step = 5e-4},
                      {.key = "size_m",
                       .meaning = "size of the object along x and y",
                       .count = 2,
                       .scale = 0.02,
                       .lowest = 1e-4,
                       .highest = 2.0,
                       .is_strength = false,
                       .step = 5e-4}},
       .scan = LightEffectKind::Scan::shadow,
       .act =
           [](LightState& state, size_t frame, Numbers x) {
             constexpr double half_thickness_m = 1e-3;
             const Vec3 centre(x[1], x[2], x[3]), half(0.5 * x[4], 0.5 * x[5], half_thickness_m);
             state.boxes.push_back({frame == 1, centre - half, centre + half, x[0]});
           }},
      // A rotation vector about lab x and y.
      {.name = "attitude_bias",
       .explanation = "the attitude of the platform differs from the recorded one",
       .parameters = {{.key = "bias_deg",
                       .meaning = "rotation about lab x and lab y",
                       .count = 2,
                       .scale = 0.02,
                       .lowest = -0.3,
                       .highest = 0.3}},
       .is_traced = true,
       .act = [](LightState& state, size_t,
                 Numbers x) { state.attitude_bias_rad += Vec2(x[0], x[1]); }},
      {.name = "interreflection",
       .explanation = "a wall that is assumed black scatters light",
       .index = Index::wall,
       .parameters = {from_zero(
           "diffuse", "fraction of the light that the wall scatters by Lambert's law", 0.3, 1.0)},
       .act =
           [](LightState& state, size_t index, Numbers x) {
             state.walls.push_back({index, x[0], 0.0});
           }},
      {.name = "interreflection",
       .explanation = "a wall that is assumed black mirrors light",
       .index = Index::wall,
       .parameters = {from_zero("specular", "fraction of the light that the wall mirrors", 0.3,
                                1.0)},
       .act =
           [](LightState& state, size_t index, Numbers x) {
             state.walls.push_back({index, 0.0, x[0]});
           }},
      {.name = "detector_gain",
       .explanation = "the photodiode reads too much or too little by one factor",
       .parameters = {gain_factor("factor on the readings of a scan")},
       .in_sweeps = false,
       .in_runs = false,
       .act = multiplies(&LightState::detector_gain)},
  };
}

}  // namespace photorque
