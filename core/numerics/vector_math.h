// Elementary functions without branches or calls, so that a loop of them over a block of rays is
// vectorised by the compiler. They are evaluated in the same order on every machine with the same
// instruction set.
//
// The polynomials are minimax in relative error, found by Remez' exchange algorithm with 60 digits;
// the errors quoted are of the rounded double results against exact values.
#pragma once

#include <bit>
#include <cstdint>
#include <numbers>

namespace photorque {

// A 32-bit fixed-point fraction as a double in (0, 1), exact and equal to sobol_fraction(). It
// converts signed integers, because AVX2 has no conversion of unsigned ones.
inline double fraction_of(uint32_t bits) {
  return (static_cast<double>(static_cast<int32_t>(bits ^ 0x80000000u)) + 2147483648.5) * 0x1p-32;
}

// 1 − fraction_of(bits), exact and in (0, 1): small where the fraction is close to one.
inline double remainder_of(uint32_t bits) {
  return fraction_of(~bits);
}

// sin 2πx for x ∈ [−1/4, 1/4], relative error below 3e-16.
inline double sin_quarter_turn(double x) {
  const double z = x * x;
  double p = 0.10085632779802037;
  p = p * z - 0.71772357942049390;
  p = p * z + 3.8199270504051837;
  p = p * z - 15.094641620506104;
  p = p * z + 42.058693923785124;
  p = p * z - 76.705859752798496;
  p = p * z + 81.605249276073406;
  p = p * z - 41.341702240399756;
  p = p * z + 6.2831853071795865;
  return p * x;
}

// The point of the unit circle at a fraction of a turn given by 32 bits, absolute error below 4e-16
// in each coordinate.
struct CirclePoint {
  double cos;
  double sin;
};
inline CirclePoint circle_point(uint32_t bits) {
  // The bits are read as a signed integer, which gives (−1/2, 1/2) turns.
  const double x = (static_cast<double>(static_cast<int32_t>(bits)) + 0.5) * 0x1p-32;
  const double size = x < 0.0 ? -x : x;
  const double to_half = 0.5 - size;
  const double folded = size < to_half ? size : to_half;  // sin 2πx = sin 2π(1/2 − x)
  return {sin_quarter_turn(0.25 - size), sin_quarter_turn(x < 0.0 ? -folded : folded)};
}

// Sine and cosine in single precision, with twice as many numbers in a register.

// An integer as a float, rounded once. It is converted in halves, because AVX2 converts only signed
// integers.
inline float single_of(uint32_t number) {
  return static_cast<float>(static_cast<int32_t>(number >> 16)) * 65536.0f +
         static_cast<float>(static_cast<int32_t>(number & 0xffffu));
}

// A 32-bit fixed-point fraction in (0, 1], relative error below 2e-7 except for the smallest.
inline float single_fraction(uint32_t bits) {
  return (single_of(bits) + 0.5f) * 0x1p-32f;
}

// sin 2πx for x ∈ [−1/4, 1/4], relative error below 3e-7.
inline float single_sin_quarter_turn(float x) {
  const float z = x * x;
  float p = 39.7109180f;
  p = p * z - 76.5749922f;
  p = p * z + 81.6022312f;
  p = p * z - 41.3416775f;
  p = p * z + 6.28318527f;
  return p * x;
}

// Absolute error below 2e-7 in each coordinate.
struct SingleCirclePoint {
  float cos;
  float sin;
};
inline SingleCirclePoint single_circle_point(uint32_t bits) {
  const float x = static_cast<float>(static_cast<int32_t>(bits)) * 0x1p-32f;
  const float size = x < 0.0f ? -x : x;
  const float to_half = 0.5f - size;
  const float folded = size < to_half ? size : to_half;
  return {single_sin_quarter_turn(0.25f - size),
          single_sin_quarter_turn(x < 0.0f ? -folded : folded)};
}

// Natural logarithm of a normal x > 0, relative error below 5e-16.
// Method: x = 2^k m with m ∈ [√½, √2), ln m = 2 artanh s with s = (m − 1)/(m + 1).
inline double log_positive(double x) {
  constexpr uint64_t half_sqrt = 0x3fe6a09e667f3bcdull;  // bits of √½
  constexpr uint64_t one = 0x3ff0000000000000ull;
  constexpr uint64_t mantissa = 0x000fffffffffffffull;
  constexpr uint64_t two_to_52 = 0x4330000000000000ull;
  const uint64_t shifted = std::bit_cast<uint64_t>(x) + (one - half_sqrt);
  const double m = std::bit_cast<double>((shifted & mantissa) + half_sqrt);
  // An integer below 2^52 in the low bits of 2^52 becomes a double by one subtraction.
  const double k = std::bit_cast<double>((shifted >> 52) | two_to_52) - (0x1p52 + 1023.0);
  const double s = (m - 1.0) / (m + 1.0);
  const double z = s * s;
  double p = 0.14810529836445051;
  p = p * z + 0.15312443756887173;
  p = p * z + 0.18183635094193460;
  p = p * z + 0.22222196988250447;
  p = p * z + 0.28571428761346604;
  p = p * z + 0.39999999999298883;
  p = p * z + 0.66666666666667652;
  return k * std::numbers::ln2 + (2.0 * s + s * z * p);
}

}  // namespace photorque
