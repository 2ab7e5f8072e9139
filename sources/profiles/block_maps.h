// Area-preserving maps from blocks of random fractions to discs and spheres. Vectorised.
#pragma once

#include <array>
#include <cstdint>

#include "raytrace/emitter.h"

namespace photorque {

using FractionBlock = std::array<uint32_t, ray_block>;
using ValueBlock = std::array<float, ray_block>;
using VectorBlock = std::array<ValueBlock, 3>;

// Points evenly over a disc about the z axis at z = 0: radius from the square root of the first
// fraction, azimuth from the second. Polar rather than concentric: every ring then holds its
// fraction of a stratified set exactly.
void fill_disc(double radius_m, const FractionBlock& radial, const FractionBlock& turn,
               VectorBlock& point_m);

// Unit vectors at 1 − cos θ = `rise` from the z axis, azimuth from a fraction. The norm is 1 to
// 2e-7; directions keep their relative precision down to the narrowest beams.
void fill_directions(const ValueBlock& rise, const FractionBlock& turn, VectorBlock& direction);

}  // namespace photorque
