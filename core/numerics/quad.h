// Four numbers in one vector register.
#pragma once

#include <cstdint>
#include <cstring>

#ifdef __FMA__
#include <immintrin.h>
#endif

namespace photorque {

using Quad = double __attribute__((vector_size(32)));
using QuadBits = int64_t __attribute__((vector_size(32)));
using QuadWords = uint64_t __attribute__((vector_size(32)));

inline Quad quad_at(const double* from) {
  Quad lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

inline QuadBits bits_of(Quad x) {
  return reinterpret_cast<QuadBits>(x);
}

inline double sum_of(Quad x) {
  return (x[0] + x[1]) + (x[2] + x[3]);
}

// a · b + c, rounded once where the machine can.
inline Quad multiply_add(Quad a, Quad b, Quad c) {
#ifdef __FMA__
  return reinterpret_cast<Quad>(_mm256_fmadd_pd(
      reinterpret_cast<__m256d>(a), reinterpret_cast<__m256d>(b), reinterpret_cast<__m256d>(c)));
#else
  return a * b + c;
#endif
}

// Four rows of four numbers become four columns.
struct FourColumns {
  Quad a, b, c, d;
};

inline FourColumns transposed(Quad a, Quad b, Quad c, Quad d) {
  const Quad ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Quad ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Quad cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Quad cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return {__builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5),
          __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5),
          __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7),
          __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7)};
}

}  // namespace photorque
