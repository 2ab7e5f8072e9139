// torque-map over directions of light: the table of a body in sunlight.
#pragma once

#include "tools/runs/optical_run.h"

namespace photorque {

// Traces the body with the Sun at every direction of [torque_map] and writes the wrench per
// pressure, also in the SPAD layout when the directions cover the sphere. The experiment's only
// source must be a sun.
void map_over_direction(const CommandLine& line, Console& console, const OpticalRun& run);

}  // namespace photorque
