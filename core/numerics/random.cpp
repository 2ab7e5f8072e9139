#include "core/numerics/random.h"

#include <bit>

#include "core/numerics/sobol_matrices.h"

namespace photorque {
namespace {

using namespace sobol_matrices;

// Contribution of each byte of the index: [dimension][byte][value]. The lowest byte is the index
// within a block.
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

namespace {

// The sum of the basis vectors that the bits of `which` select.
uint32_t combine(const std::vector<uint32_t>& basis, uint32_t which) {
  uint32_t sum = 0;
  for (const uint32_t vector : basis) {
    if ((which & 1u) != 0) sum ^= vector;
    which >>= 1;
  }
  return sum;
}

// Equations over the bits of an index, each with a pivot bit that no other equation contains.
struct Equations {
  std::vector<uint32_t> row, pivot;  // pivot: one bit set

  void add(uint32_t equation) {
    for (size_t j = 0; j < row.size(); ++j) {
      if ((equation & pivot[j]) != 0) equation ^= row[j];
    }
    const uint32_t bit = std::bit_floor(equation);
    for (uint32_t& other : row) {
      if ((other & bit) != 0) other ^= equation;
    }
    row.push_back(equation);
    pivot.push_back(bit);
  }
};

// Bit `bit` of the reversed coordinate, as a sum of bits of the index.
uint32_t equation_of(int dimension, int bit, int log2_points) {
  uint32_t equation = 0;
  for (int k = 0; k < log2_points; ++k) {
    equation |= ((columns[dimension][k] >> bit) & 1u) << k;
  }
  return equation;
}

}  // namespace

SobolCells::SobolCells(int log2_points, const std::array<int, sobol_dimensions>& leading_bits) {
  Equations equations;
  for (int d = 0; d < sobol_dimensions; ++d) {
    for (int bit = 0; bit < leading_bits[d]; ++bit) {
      equations.add(equation_of(d, bit, log2_points));
    }
  }
  cell_basis_ = equations.pivot;
  uint32_t pivots = 0;
  for (const uint32_t pivot : equations.pivot) pivots |= pivot;
  for (int k = 0; k < log2_points; ++k) {  // each free bit with the pivots that cancel it
    const uint32_t free = uint32_t{1} << k;
    if ((pivots & free) != 0) continue;
    uint32_t vector = free;
    for (size_t j = 0; j < equations.row.size(); ++j) {
      if ((equations.row[j] & free) != 0) vector |= equations.pivot[j];
    }
    inner_basis_.push_back(vector);
  }
  for (uint32_t i = 0; i < sobol_block; ++i) {
    block_index_[i] = combine(inner_basis_, i);
    for (int d = 0; d < sobol_dimensions; ++d) {
      block_point_[d][i] = reversed_point(d, block_index_[i]);
    }
  }
}

void SobolCells::points(const SobolStream& stream, uint32_t cell, uint32_t first,
                        const std::array<uint32_t*, sobol_dimensions>& out, uint32_t* index) const {
  const uint32_t offset = combine(cell_basis_, cell) ^ combine(inner_basis_, first);
  for (uint32_t i = 0; i < sobol_block; ++i) index[i] = offset ^ block_index_[i];
  for (int d = 0; d < sobol_dimensions; ++d) {
    scramble_block(block_point_[d].data(), reversed_point(d, offset), dimension_seed(stream, d),
                   out[d]);
  }
}

}  // namespace photorque
