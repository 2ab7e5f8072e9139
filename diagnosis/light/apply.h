// Effects that an experiment states, made part of what an optical run traces.
#pragma once

#include <string>
#include <vector>

#include "scenes/experiment/experiment.h"

namespace photorque {

// Changes beams and attitude as the experiment's [[effect]] tables say: power, failure and aim of
// single LEDs, power, width and place of all, the attitude's bias. Returns one line for each effect
// that a trace cannot show, because it acts on instruments or on the array's circuit, or is not
// traced. InputError as written_state().
std::vector<std::string> apply_written_effects(Experiment& experiment);

}  // namespace photorque
