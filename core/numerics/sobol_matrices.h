// The generator matrices and the scrambling of the Sobol points of random.h; for the implementation
// only.
#pragma once

#include <bit>
#include <cstring>

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "core/numerics/random.h"

namespace photorque::sobol_matrices {

constexpr uint32_t reverse_bits(uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

// A permutation of reversed bits in which every bit is changed only by the bits below it: on the
// fraction, that is nested uniform scrambling (Vegdahl's constants of the Laine–Karras hash). For a
// number or several ones in a vector register.
template <class Words>
constexpr Words scramble_reversed(Words x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

#ifdef __AVX2__
// Reverses the bits of eight numbers at once: half-bytes by a table, then the order of the bytes.
inline __m256i reverse_bits(__m256i x) {
  const __m256i half = _mm256_set1_epi8(0x0f);
  const __m256i reversed = _mm256_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15, 0,
                                            8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15);
  const __m256i bytes = _mm256_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12, 3, 2,
                                         1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12);
  const __m256i low = _mm256_shuffle_epi8(reversed, _mm256_and_si256(x, half));
  const __m256i high =
      _mm256_shuffle_epi8(reversed, _mm256_and_si256(_mm256_srli_epi32(x, 4), half));
  return _mm256_shuffle_epi8(_mm256_or_si256(_mm256_slli_epi32(low, 4), high), bytes);
}
#endif

// Scrambles the points reversed[i] ^ common of a block and reverses their bits into fractions.
inline void scramble_block(const uint32_t* reversed, uint32_t common, uint32_t seed,
                           uint32_t* fraction) {
#ifdef __AVX2__
  for (uint32_t i = 0; i < sobol_block; i += 8) {
    uint32_t point __attribute__((vector_size(32)));
    std::memcpy(&point, reversed + i, sizeof point);
    point = scramble_reversed(point ^ common, seed);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(fraction + i),
                        reverse_bits(reinterpret_cast<__m256i>(point)));
  }
#else
  for (uint32_t i = 0; i < sobol_block; ++i) {
    fraction[i] = reverse_bits(scramble_reversed(reversed[i] ^ common, seed));
  }
#endif
}

// Direction numbers of Joe and Kuo for the first four dimensions, as bit-reversed columns: column k
// is the contribution of bit k of the index, in the reversed fraction.
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

// The seed of the scrambling of one dimension.
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
