#include "core/sobol.h"

#include "core/random.h"

namespace photorque {
namespace {

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
constexpr std::array<Primitive, 3> primitives{
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
constexpr auto columns = reversed_columns();

// What each byte of the index contributes: [dimension][byte][value]. The lowest byte is that of a
// block.
using ByteTables = std::array<std::array<std::array<uint32_t, 256>, 4>, sobol_dimensions>;
constexpr ByteTables make_byte_tables() {
  ByteTables tables{};
  for (int d = 0; d < sobol_dimensions; ++d) {
    for (int byte = 0; byte < 4; ++byte) {
      for (uint32_t value = 0; value < 256; ++value) {
        for (int k = 0; k < 8; ++k) {
          if ((value >> k) & 1u) tables[d][byte][value] ^= columns[d][8 * byte + k];
        }
      }
    }
  }
  return tables;
}
constexpr ByteTables byte_tables = make_byte_tables();

uint32_t dimension_seed(const SobolStream& stream, int dimension) {
  return static_cast<uint32_t>(
      hash_words(stream.seed, stream.stream, stream.group, static_cast<uint64_t>(dimension)) >> 32);
}

constexpr uint32_t reversed_point(int dimension, uint32_t index) {
  uint32_t x = 0;
  for (int k = 0; index != 0; ++k, index >>= 1) {
    if (index & 1u) x ^= columns[dimension][k];
  }
  return x;
}

}  // namespace

void sobol_points(const SobolStream& stream, uint32_t first,
                  const std::array<uint32_t*, sobol_dimensions>& out) {
  for (int d = 0; d < sobol_dimensions; ++d) {
    const uint32_t high = reversed_point(d, first);
    const uint32_t seed = dimension_seed(stream, d);
    const uint32_t* table = byte_tables[d][0].data();
    uint32_t* point = out[d];
    for (uint32_t i = 0; i < sobol_block; ++i) {
      point[i] = reverse_bits(scramble_reversed(table[i] ^ high, seed));
    }
  }
}

SobolSequence::SobolSequence(const SobolStream& stream)
    : shuffled_(stream.group != 0), order_seed_(dimension_seed(stream, -1)) {
  for (int d = 0; d < sobol_dimensions; ++d) seeds_[d] = dimension_seed(stream, d);
}

std::array<double, sobol_dimensions> SobolSequence::point(uint32_t index) const {
  if (shuffled_) index = reverse_bits(scramble_reversed(reverse_bits(index), order_seed_));
  std::array<double, sobol_dimensions> point;
  for (int d = 0; d < sobol_dimensions; ++d) {
    const uint32_t x = byte_tables[d][0][index & 255u] ^ byte_tables[d][1][(index >> 8) & 255u] ^
                       byte_tables[d][2][(index >> 16) & 255u] ^ byte_tables[d][3][index >> 24];
    point[d] = sobol_fraction(reverse_bits(scramble_reversed(x, seeds_[d])));
  }
  return point;
}

}  // namespace photorque
