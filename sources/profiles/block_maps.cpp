#include "sources/profiles/block_maps.h"

#include <cmath>

#include "core/numerics/vector_math.h"

namespace photorque {

void fill_disc(double radius_m, const FractionBlock& radial, const FractionBlock& turn,
               VectorBlock& point_m) {
  const auto radius = static_cast<float>(radius_m);
  for (int i = 0; i < ray_block; ++i) {
    const float r_m = radius * std::sqrt(single_fraction(radial[i]));
    const SingleCirclePoint azimuth = single_circle_point(turn[i]);
    point_m[0][i] = r_m * azimuth.cos;
    point_m[1][i] = r_m * azimuth.sin;
    point_m[2][i] = 0.0f;
  }
}

void fill_directions(const ValueBlock& rise, const FractionBlock& turn, VectorBlock& direction) {
  for (int i = 0; i < ray_block; ++i) {
    const float sine = std::sqrt(rise[i] * (2.0f - rise[i]));
    const SingleCirclePoint azimuth = single_circle_point(turn[i]);
    direction[0][i] = sine * azimuth.cos;
    direction[1][i] = sine * azimuth.sin;
    direction[2][i] = 1.0f - rise[i];
  }
}

}  // namespace photorque
