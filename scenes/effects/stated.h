// Effects on light and power that an experiment states, such as those of `improved.toml`.
//
//   [[effect]]
//   kind = "led_derated"     # any of scenes/effects
//   index = 4                # of the lamp, cell, string or bypass diode; node = "wall" of a wall
//   factor = 0.72            # the kind's parameters
#pragma once

#include <string>
#include <vector>

#include "scenes/effects/parts.h"

namespace photorque {

// The state that all of them make together; InputError for unknown kinds, keys and indices.
LightState stated_effects(const Experiment& experiment, const LightParts& parts);

// Changes beams and attitude of the experiment to what its effects make of them, for a trace: power
// and aim of single LEDs, power, width and place of all, bias of the attitude. Returns one line for
// each effect that a trace cannot show, because it acts on instruments or on the array's circuit,
// or is not traced. InputError as light_parts() and stated_effects().
std::vector<std::string> apply_stated_effects(Experiment& experiment);

// The experiment's beams with their angular widths multiplied by `scale` > 0.
std::vector<Beam> beams_with_divergence(const Experiment& experiment, double scale);
// Where a lamp stands in the lab, displaced by `shift_m` and turned by the tangents `aim`.
RigidTransform displaced_pose(const Beam& beam, const Vec2& aim, const Vec3& shift_m);
// An attitude turned by a rotation vector about lab x and y.
Quat biased_attitude(const Quat& lab_from_body, const Vec2& bias_rad);

}  // namespace photorque
