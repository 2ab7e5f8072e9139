// Properties of a scene that make results doubtful.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/transform.h"
#include "raytrace/emitter.h"
#include "raytrace/scene.h"

namespace photorque {

// Marks closed opaque parts that contain a lamp and all other parts, such as a vacuum chamber, as
// not enclosing: their inner sides are meant to be lit.
void open_chambers(Scene& scene, std::span<const Beam> beams, const RigidTransform& lab_from_body);

// Warnings, one line each: lamps whose centre is inside a closed opaque part, at this attitude;
// parts that are too small, compared with the scene, for the single precision of ray casting.
std::vector<std::string> geometry_warnings(const Scene& scene, std::span<const Beam> beams,
                                           const RigidTransform& lab_from_body);

}  // namespace photorque
