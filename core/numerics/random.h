// Counter-based randomness: every number is a hash of what it is for, so that no order of work can
// change it.
#pragma once

#include <cstdint>

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

}  // namespace photorque
