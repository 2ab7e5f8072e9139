// Light from so far away that only its directions matter, such as sunlight.
#pragma once

#include "raytrace/emitter.h"

namespace photorque {

// An emitter whose rays fill, for each direction, a disc normal to that direction and centred on
// (0, 0, radius). The sphere of this radius about that point is lit evenly. The tracer may choose
// the points of the disc itself, also those of a smaller disc about the scene, and omit those from
// which no ray meets anything.
class ParallelLight : public Emitter {
 public:
  explicit ParallelLight(double radius_m) : radius_m_(radius_m) {}

  // Radius of the lit sphere.
  double radius_m() const { return radius_m_; }

  // Fills rays.direction from dimensions 2 and 3. The angle from the axis increases with dimension
  // 2.
  virtual void fill_directions(const SampleBlock& samples, RayBlock& rays) const = 0;

  // Places each point (x, y) of rays.origin_m on the disc of its ray. The point is turned by the
  // shortest rotation from z to the ray's direction, moved to (0, 0, height_m), and moved back
  // along the ray to the plane z = 0. Source of the axes: J. R. Frisvad, J. Graphics Tools 16
  // (2012) 151.
  static void place_on_discs(double height_m, RayBlock& rays) {
    for (int i = 0; i < ray_block; ++i) {
      const double dx = rays.direction[0][i], dy = rays.direction[1][i], dz = rays.direction[2][i];
      const double a_m = rays.origin_m[0][i], b_m = rays.origin_m[1][i];
      const double along_m = a_m * dx + b_m * dy;
      const double bend_m = along_m / (1.0 + dz);
      const double back_m = (height_m - along_m) / dz;
      rays.origin_m[0][i] = static_cast<float>(a_m - bend_m * dx - back_m * dx);
      rays.origin_m[1][i] = static_cast<float>(b_m - bend_m * dy - back_m * dy);
      rays.origin_m[2][i] = 0.0f;
    }
  }

 private:
  double radius_m_;
};

}  // namespace photorque
