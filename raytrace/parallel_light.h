// Light from so far away that only its directions matter: the Sun.
#pragma once

#include "raytrace/emitter.h"

namespace photorque {

// An emitter whose rays fill, for each direction, a disc normal to THAT direction and centred on
// (0, 0, radius), so that the sphere of this radius there is lit evenly. The tracer may then choose
// the points of the disc itself, also of a smaller disc about the scene, and leave out those from
// which no ray meets anything.
class ParallelLight : public Emitter {
 public:
  explicit ParallelLight(double radius_m) : radius_m_(radius_m) {}

  double radius_m() const { return radius_m_; }

  // Fills rays.direction from dimensions 2 and 3. The angle from the axis rises with dimension 2.
  virtual void fill_directions(const SampleBlock& samples, RayBlock& rays) const = 0;

  // Turns each point (x, y) of the disc in rays.origin_m by the shortest rotation from z to its
  // direction, moves it to (0, 0, height_m), and back along the ray to the plane z = 0.
  // Source of the axes: J. R. Frisvad, J. Graphics Tools 16 (2012) 151.
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
