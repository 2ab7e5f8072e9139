// Four numbers in one vector register: the base of all arithmetic on several numbers at once.
//
// A Quad is a vector of the compiler: + − · / and comparisons are its operators, and `mask ? a : b`
// selects number by number. Lanes (lanes.h) are eight numbers, DualLanes (dual.h) eight numbers
// with derivatives.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#ifdef __FMA__
#include <immintrin.h>
#endif

namespace photorque {

using Quad = double __attribute__((vector_size(32)));
// Results of comparisons: all bits set where true.
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

// a · b + c, rounded once on machines with fused multiply-add.
inline Quad multiply_add(Quad a, Quad b, Quad c) {
#ifdef __FMA__
  return reinterpret_cast<Quad>(_mm256_fmadd_pd(
      reinterpret_cast<__m256d>(a), reinterpret_cast<__m256d>(b), reinterpret_cast<__m256d>(c)));
#else
  return a * b + c;
#endif
}

inline bool all_of(QuadBits mask) {
  return (mask[0] & mask[1] & mask[2] & mask[3]) != 0;
}
inline bool any_of(QuadBits mask) {
  return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
}

// a where the mask is set, otherwise b; for code that is written once for numbers and vectors.
inline Quad select(QuadBits mask, Quad a, Quad b) {
  return mask ? a : b;
}
inline double select(bool condition, double a, double b) {
  return condition ? a : b;
}

inline Quad abs(Quad x) {
  return reinterpret_cast<Quad>(bits_of(x) & std::numeric_limits<int64_t>::max());
}
// Like std::max and std::min, they return a if a or b is NaN.
inline Quad max(Quad a, Quad b) {
  return a < b ? b : a;
}
inline Quad min(Quad a, Quad b) {
  return b < a ? b : a;
}
// True where x is neither infinite nor NaN.
inline QuadBits is_finite(Quad x) {
  return abs(x) <= std::numeric_limits<double>::max();
}

// Applies a function of Eigen's arrays to each number. The square root is correctly rounded; exp
// and log are accurate to one unit in the last place.
template <class Function>
Quad as_array(Quad x, const Function& function) {
  Eigen::Array4d array;
  std::memcpy(array.data(), &x, sizeof x);
  array = function(array);
  return quad_at(array.data());
}
inline Quad sqrt(Quad x) {
  return as_array(x, [](const auto& a) { return a.sqrt(); });
}
inline Quad exp(Quad x) {
  return as_array(x, [](const auto& a) { return a.exp(); });
}
inline Quad log(Quad x) {
  return as_array(x, [](const auto& a) { return a.log(); });
}

// The columns of a matrix of four rows of four numbers.
struct FourColumns {
  Quad a, b, c, d;
};

// Transposes the rows a, b, c, d.
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
