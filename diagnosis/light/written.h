// Effects on light and power that an experiment states: what `improved.toml` says of them.
//
//   [[effect]]
//   kind = "led_derated"     # any of diagnosis/light/effects
//   index = 4                # of the lamp, cell, string or bypass diode; node = "wall" of a wall
//   factor = 0.72            # the kind's parameters
#pragma once

#include "diagnosis/light/model/lab.h"

namespace photorque {

// The state that they make together; InputError for unknown kinds, keys and indices.
LightState written_state(const LightLab& lab);

}  // namespace photorque
