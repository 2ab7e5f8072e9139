// Owen-scrambled Sobol points in four dimensions, in blocks.
//
// Sources: I. M. Sobol' (1967) with the direction numbers of S. Joe and F. Y. Kuo (SIAM J. Sci.
// Comput. 30, 2008, file new-joe-kuo-6); nested uniform scrambling (A. B. Owen, 1995) by hashing as
// in B. Burley, "Practical hash-based Owen scrambling" (JCGT 9(4), 2020), with the permutation of
// N. Vegdahl (2021). Further dimensions come from padding: four at a time, each group with its own
// scrambled order of the points (Burley, section 4).
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace photorque {

inline constexpr int sobol_dimensions = 4;

// Points per block; blocks start at multiples of this.
inline constexpr uint32_t sobol_block = 256;

// Which scrambled sequence: every different (seed, stream, group) gives an independent scrambling
// of the same point set. `group` 0 keeps the order of the points (so blocks stay well distributed
// among themselves); other groups also scramble the order and serve as padding.
struct SobolStream {
  uint64_t seed = 0;
  uint64_t stream = 0;
  uint32_t group = 0;
};

// Writes points first … first + sobol_block − 1 of the stream, as 32-bit fixed-point fractions, to
// four arrays of sobol_block. `first` must be a multiple of sobol_block; stream.group must be 0.
void sobol_points(const SobolStream& stream, uint32_t first,
                  const std::array<uint32_t*, sobol_dimensions>& out);

// Single points of a stream, any group. Holds the stream's scrambling ready: make one for many
// points.
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

}  // namespace photorque
