// Properties of a scene that make results doubtful.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/transform.h"
#include "raytrace/emitter.h"
#include "raytrace/scene.h"

namespace photorque {

// One line each, for warnings: lamps whose
// middle stands inside a closed part that lets no light through, at this attitude; parts so small
// beside the scene that single precision, in which rays are cast, does not resolve them.
std::vector<std::string> doubts_about(const Scene& scene, std::span<const Beam> beams,
                                      const RigidTransform& lab_from_body);

}  // namespace photorque
