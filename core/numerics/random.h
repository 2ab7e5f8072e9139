// Counter-based random numbers: every number is a hash of its purpose, so the order of computation
// has no influence. Owen-scrambled Sobol points, in blocks and in cells.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace photorque {

// A bijective 64-bit mix with full avalanche.
// Source: D. Stafford, "Better bit mixing" (2011), variant 13 of the MurmurHash3 finaliser, as used
// in splitmix64 (Steele, Lea, Flood, OOPSLA 2014).
constexpr uint64_t mix_bits(uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ull;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// A 64-bit hash of up to four words (seed, stream, index, dimension).
constexpr uint64_t hash_words(uint64_t a, uint64_t b = 0, uint64_t c = 0, uint64_t d = 0) {
  uint64_t h = mix_bits(a + 0x9e3779b97f4a7c15ull);
  h = mix_bits(h ^ (b + 0x9e3779b97f4a7c15ull));
  h = mix_bits(h ^ (c + 0xd1b54a32d192ed03ull));
  return mix_bits(h ^ (d + 0x8cb92ba72f3d8dd7ull));
}

// Uniform in (0, 1), never either end, from the 52 high bits of a hash.
constexpr double unit_interval(uint64_t hash) {
  return (static_cast<double>(hash >> 12) + 0.5) * 0x1p-52;
}

// Owen-scrambled Sobol points in four dimensions, in blocks.
//
// Sources: I. M. Sobol' (1967) with the direction numbers of S. Joe and F. Y. Kuo (SIAM J. Sci.
// Comput. 30, 2008, file new-joe-kuo-6); nested uniform scrambling (A. B. Owen, 1995) by hashing as
// in B. Burley, "Practical hash-based Owen scrambling" (JCGT 9(4), 2020), with the permutation of
// N. Vegdahl (2021). Further dimensions come from padding: four at a time, each group with its own
// scrambled order of the points (Burley, section 4).

inline constexpr int sobol_dimensions = 4;

// Points per block; blocks start at multiples of this.
inline constexpr uint32_t sobol_block = 256;

// Identifies a scrambled sequence: every (seed, stream, group) gives an independent scrambling of
// the same point set. Group 0 keeps the order of the points, so that blocks remain well distributed
// among themselves. Other groups also scramble the order and serve as padding.
struct SobolStream {
  uint64_t seed = 0;
  uint64_t stream = 0;
  uint32_t group = 0;
};

// Writes points first … first + sobol_block − 1 of the stream, as 32-bit fixed-point fractions, to
// four arrays of sobol_block. `first` must be a multiple of sobol_block; stream.group must be 0.
void sobol_points(const SobolStream& stream, uint32_t first,
                  const std::array<uint32_t*, sobol_dimensions>& out);

// Single points of a stream, of any group. The constructor prepares the scrambling, so one object
// should serve many points.
class SobolSequence {
 public:
  explicit SobolSequence(const SobolStream& stream);

  // Point `index` as fractions in (0, 1).
  std::array<double, sobol_dimensions> point(uint32_t index) const;

 private:
  bool shuffled_;
  uint32_t order_seed_;
  std::array<uint32_t, sobol_dimensions> seeds_;
};

// A 32-bit fixed-point fraction as a double in (0, 1): the middle of its cell.
constexpr double sobol_fraction(uint32_t bits) {
  return (static_cast<double>(bits) + 0.5) * 0x1p-32;
}

// Sobol points cell by cell: points that are neighbours in the unit hypercube are generated
// together, without sorting.
//
// The leading bits of the coordinates of a Sobol point are linear in the bits of its index, over
// the field of two elements. All indices whose points share given leading bits therefore form an
// affine subspace, which is enumerated directly; nested scrambling maps cells to cells.

// The first 2^log2_points points of a sequence of group 0, in cells of equal size.
class SobolCells {
 public:
  // The points of a cell share the `leading_bits[d]` first bits of coordinate d. log2_points ∈ [8,
  // 31]; the bits together ≤ log2_points − 8, so that they are independent of each other.
  SobolCells(int log2_points, const std::array<int, sobol_dimensions>& leading_bits);

  uint32_t cells() const { return uint32_t{1} << cell_basis_.size(); }
  uint32_t points_per_cell() const { return uint32_t{1} << inner_basis_.size(); }

  // Writes points first … first + sobol_block − 1 of a cell to four arrays of sobol_block, as
  // sobol_points() does, and their indices in the sequence. `first` must be a multiple of
  // sobol_block.
  void points(const SobolStream& stream, uint32_t cell, uint32_t first,
              const std::array<uint32_t*, sobol_dimensions>& out, uint32_t* index) const;

 private:
  // Bases of subspaces over exclusive or: sums of `cell_basis_` give one index in every cell, and
  // sums of `inner_basis_` all indices of the first cell.
  std::vector<uint32_t> cell_basis_, inner_basis_;
  // The first block of the first cell: indices, and points before scrambling, their bits reversed.
  std::array<uint32_t, sobol_block> block_index_;
  std::array<std::array<uint32_t, sobol_block>, sobol_dimensions> block_point_;
};

}  // namespace photorque
