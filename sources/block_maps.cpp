#include "sources/block_maps.h"

#include <cmath>

#include "sources/vector_math.h"

namespace photorque {

void fill_disc(double radius_m, const FractionBlock& radial, const FractionBlock& turn,
               VectorBlock& point_m) {
  for (int i = 0; i < ray_block; ++i) {
    const double r_m = radius_m * std::sqrt(fraction_of(radial[i]));
    const CirclePoint azimuth = circle_point(turn[i]);
    point_m[0][i] = r_m * azimuth.cos;
    point_m[1][i] = r_m * azimuth.sin;
    point_m[2][i] = 0.0;
  }
}

void fill_directions(const ValueBlock& rise, const FractionBlock& turn, VectorBlock& direction) {
  for (int i = 0; i < ray_block; ++i) {
    const double sine = std::sqrt(rise[i] * (2.0 - rise[i]));
    const CirclePoint azimuth = circle_point(turn[i]);
    direction[0][i] = sine * azimuth.cos;
    direction[1][i] = sine * azimuth.sin;
    direction[2][i] = 1.0 - rise[i];
  }
}

}  // namespace photorque
