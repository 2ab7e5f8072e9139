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

// The most first. Planes that differ by less than 2e-7 of the scene's size count as one, which is
// what single precision tells apart. Looks at no more pairs than take about a second.
std::vector<CoincidentFaces> coincident_faces(const Scene& scene);

}  // namespace photorque
