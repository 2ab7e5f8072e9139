// torque-map over directions of light: the table of a body in sunlight.
#pragma once

#include "tools/tasks/torque_map.h"

namespace photorque {

// Traces the body with the Sun at every direction of [torque_map]. When the directions cover the
// sphere, the wrench per pressure is a file of the result in the SPAD layout. The experiment's only
// source must be a sun. Directions are shared out over `threads` (0: all); `shared` itself is best
// made for one.
TorqueMapRun map_over_direction(const Console& console,
                                const std::shared_ptr<const OpticalRun>& shared, int threads,
                                const NodeWatch& watch = {});

}  // namespace photorque
