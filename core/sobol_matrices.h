// The generator matrices and the scrambling behind sobol.h; for its files only.
#pragma once

#include <bit>

#include "core/random.h"
#include "core/sobol.h"

namespace photorque::sobol_matrices {

constexpr uint32_t reverse_bits(uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

// A permutation of reversed bits in which every bit is changed only by the bits below it: on the
// fraction, that is nested uniform scrambling (Vegdahl's constants of the Laine–Karras hash).
constexpr uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// Direction numbers of Joe and Kuo for the first four dimensions, as bit-reversed columns: column k
// is what bit k of the index contributes, in the reversed fraction.
struct Primitive {
  int degree;
  uint32_t coefficients;
  std::array<uint32_t, 3> initial;
};
inline constexpr std::array<Primitive, 3> primitives{
    {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}}};

constexpr std::array<std::array<uint32_t, 32>, sobol_dimensions> reversed_columns() {
  std::array<std::array<uint32_t, 32>, sobol_dimensions> columns{};
  for (int k = 0; k < 32; ++k) columns[0][k] = 1u << k;  // van der Corput, reversed
  for (int d = 1; d < sobol_dimensions; ++d) {
    const Primitive& p = primitives[d - 1];
    std::array<uint32_t, 32> v{};
    for (int k = 0; k < 32; ++k) {
      if (k < p.degree) {
        v[k] = p.initial[k] << (31 - k);
        continue;
      }
      v[k] = v[k - p.degree] ^ (v[k - p.degree] >> p.degree);
      for (int j = 1; j < p.degree; ++j) {
        if ((p.coefficients >> (p.degree - 1 - j)) & 1u) v[k] ^= v[k - j];
      }
    }
    for (int k = 0; k < 32; ++k) columns[d][k] = reverse_bits(v[k]);
  }
  return columns;
}
inline constexpr auto columns = reversed_columns();

// What selects the scrambling of one dimension.
inline uint32_t dimension_seed(const SobolStream& stream, int dimension) {
  return static_cast<uint32_t>(
      hash_words(stream.seed, stream.stream, stream.group, static_cast<uint64_t>(dimension)) >> 32);
}

// Coordinate `dimension` of point `index` before scrambling, its bits reversed.
constexpr uint32_t reversed_point(int dimension, uint32_t index) {
  uint32_t point = 0;
  for (; index != 0; index &= index - 1) point ^= columns[dimension][std::countr_zero(index)];
  return point;
}

}  // namespace photorque::sobol_matrices
