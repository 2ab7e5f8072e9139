// Effects on light and power that an experiment states, such as those of `improved.toml`.
//
//   [[effect]]
//   kind = "led_derated"     # any of scenes/effects
//   index = 4                # of the lamp, cell, string or bypass diode; node = "wall" of a wall
//   factor = 0.72            # the kind's parameters
#pragma once

#include <string>
#include <vector>

#include "core/settings/keys.h"
#include "scenes/effects/parts.h"

namespace photorque {

// The light state with all effects of the experiment. Throws InputError for unknown kinds, keys and
// indices.
LightState stated_effects(const Experiment& experiment, const LightParts& parts);

// Applies the effects of the experiment to its beams and its attitude, for a trace: power and aim
// of single LEDs; power, beam width and position of all LEDs; attitude bias. Returns one line for
// each effect that a trace does not include: it acts on instruments or on the circuit of the array,
// or it is not supported in traces. Throws InputError like light_parts() and stated_effects().
std::vector<std::string> apply_stated_effects(Experiment& experiment);

// The kinds of [[effect]] on light and power with their keys. Kinds with equal names form one
// choice with the keys of all.
std::vector<Key::Choice> light_effects();

// The experiment's beams with their angular widths multiplied by `scale` > 0.
std::vector<Beam> beams_with_divergence(const Experiment& experiment, double scale);
// The pose of a lamp in the lab, displaced by `shift_m` and rotated by angles with tangents `aim`.
RigidTransform displaced_pose(const Beam& beam, const Vec2& aim, const Vec3& shift_m);
// An attitude rotated by a rotation vector about lab x and y.
Quat biased_attitude(const Quat& lab_from_body, const Vec2& bias_rad);

}  // namespace photorque
