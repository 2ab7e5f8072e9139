// torque-map over directions of light: the table of a body in sunlight.
#pragma once

#include "tools/coupling/couple.h"
#include "tools/tasks/torque_map.h"

namespace photorque {

// Force and torque with the Sun at every direction of [torque_map]: by quadrature where the scene
// is for that, else by rays. When the directions cover the sphere, the wrench per pressure is a
// file of the result in the SPAD layout. The experiment's only source must be a sun. Directions are
// shared out over `threads` (0: all); `shared` itself is best made for one. `watch` has each traced
// for it. With a checkpoint what is done is kept there now and then, and gone on from.
TorqueMapRun map_over_direction(const Console& console,
                                const std::shared_ptr<const OpticalRun>& shared, int threads,
                                const NodeWatch& watch = {}, CheckpointFile* checkpoint = nullptr);

}  // namespace photorque
