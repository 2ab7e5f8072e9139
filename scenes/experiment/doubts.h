// What in a scene makes results doubtful, although it can be traced, such as faces that lie in each
// other.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/transform.h"
#include "raytrace/emitter.h"
#include "raytrace/scene.h"

namespace photorque {

// Triangles of two instances that look the same way from the same plane and overlap. Which of them
// a ray meets is left to rounding. (Faces that look at each other are where one part stands on
// another; no light gets there.)
struct CoincidentFaces {
  uint32_t first = 0, second = 0;  // instances
  size_t triangles = 0;            // pairs of them
};

// The most first. Planes count as one whose distances from the origin round to the same multiple of
// 2e-7 of the scene's size, which is what single precision tells apart, and their normals to the
// same of 1e-5: some that lie as close on two sides of a step are missed. Looks at no more pairs
// than take about a second.
std::vector<CoincidentFaces> coincident_faces(const Scene& scene);

// One line each, for warnings: faces that lie in each other (coincident_faces()); lamps whose
// middle stands inside a closed part that lets no light through, at this attitude; parts so small
// beside the scene that single precision, in which rays are cast, does not resolve them.
std::vector<std::string> doubts_about(const Scene& scene, std::span<const Beam> beams,
                                      const RigidTransform& lab_from_body);

}  // namespace photorque
