// Faces that lie in each other: which of them a ray meets is left to rounding.
#pragma once

#include <cstdint>
#include <vector>

#include "raytrace/scene.h"

namespace photorque {

// Triangles of two instances that look the same way from the same plane and overlap. (Faces that
// look at each other are where one part stands on another; no light gets there.)
struct CoincidentFaces {
  uint32_t first = 0, second = 0;  // instances
  size_t triangles = 0;            // pairs of them
};

// The most first. Planes count as one whose distances from the origin round to the same multiple of
// 2e-7 of the scene's size, which is what single precision tells apart, and their normals to the
// same of 1e-5: some that lie as close on two sides of a step are missed. Looks at no more pairs
// than take about a second.
std::vector<CoincidentFaces> coincident_faces(const Scene& scene);

}  // namespace photorque
