#include "core/numerics/sobol.h"

#include "core/numerics/sobol_matrices.h"

namespace photorque {
namespace {

using namespace sobol_matrices;

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

}  // namespace

void sobol_points(const SobolStream& stream, uint32_t first,
                  const std::array<uint32_t*, sobol_dimensions>& out) {
  for (int d = 0; d < sobol_dimensions; ++d) {
    scramble_block(byte_tables[d][0].data(), reversed_point(d, first), dimension_seed(stream, d),
                   out[d]);
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
