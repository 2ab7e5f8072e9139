// Some of the rays of lamps, to be drawn.
#pragma once

#include <vector>

#include "raytrace/emitter.h"
#include "raytrace/tracing/tracer.h"

namespace photorque {

// Whether a lamp is too far from a scene of `radius_m` about the lab origin to be drawn beside it,
// or has no place at all (parallel light).
bool stands_far(const Beam& beam, double radius_m);

// About so many rays, shared evenly by the lamps, as these emit them: lab frame, x, y, z of where
// each starts (near the scene) and of where it first meets something, or leaves the scene's
// surroundings. Of far lamps those that pass the scene are left out.
std::vector<float> shown_rays(const TraceableScene& scene, const std::vector<Beam>& beams,
                              const RigidTransform& lab_from_body, double radius_m, size_t about);

}  // namespace photorque
