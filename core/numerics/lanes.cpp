#include "core/numerics/lanes.h"

#include <bit>

namespace photorque {
namespace {

// |x| below this many quarter turns is reduced with exact products.
constexpr double max_quarter_turns = 0x1p24;

// x = n π/2 + rest, |rest| ≤ π/4; `quarter` holds n in its low bits. π/2 comes in pieces of at most
// 28 bits, so that their products with n are exact (W. J. Cody, W. Waite, Software Manual for the
// Elementary Functions, 1980, chapter 8).
struct Reduced {
  Quad rest;
  QuadBits quarter;
};
Reduced reduce(const Quad& x) {
  constexpr double two_over_pi = 0x1.45f306dc9c883p-1;
  // Adding this leaves the nearest integer in the low bits.
  constexpr double to_integer = 0x1.8p52;
  const Quad shifted = x * two_over_pi + to_integer;
  const Quad n = shifted - to_integer;
  Quad rest = x - n * 0x1.921fb54p+0;
  rest -= n * 0x1.10b461p-30;
  rest -= n * 0x1.a626330p-58;
  rest -= n * 0x1.45c06e0e68948p-86;
  return {rest, std::bit_cast<QuadBits>(shifted)};
}

// Minimax polynomials of sin and cos on [−π/4, π/4], errors below 2^−58.
// Source: FreeBSD msun, k_sin.c and k_cos.c (Sun Microsystems 1993).
Quad sin_kernel(const Quad& x) {
  const Quad z = x * x;
  const Quad r = 8.33333333332248946124e-03 +
                 z * (-1.98412698298579493134e-04 +
                      z * (2.75573137070700676789e-06 +
                           z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  return x + x * z * (-1.66666666666666324348e-01 + z * r);
}
Quad cos_kernel(const Quad& x) {
  const Quad z = x * x;
  const Quad r =
      4.16666666666666019037e-02 +
      z * (-1.38888888888741095749e-03 +
           z * (2.48015872894767294178e-05 +
                z * (-2.75573143513906633035e-07 +
                     z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
  return 1.0 - (0.5 * z - z * z * r);
}

// Whether reduce() is accurate for all lanes. For NaN both methods return NaN.
bool is_reducible(const Lanes& x) {
  return largest(larger_magnitude(x, 0.0)) < 1.5 * max_quarter_turns;
}

// sin(x + quarters π/2).
Quad shifted_sin(const Quad& x, int64_t quarters) {
  const Reduced reduced = reduce(x);
  const QuadBits quarter = reduced.quarter + quarters;
  const Quad s = sin_kernel(reduced.rest), c = cos_kernel(reduced.rest);
  const Quad value = (quarter & 1) != 0 ? c : s;
  return (quarter & 2) != 0 ? -value : value;
}

// Arctangent on [−tan π/8, tan π/8], error below 2e-16. Source: S. L. Moshier, Cephes (atan.c).
Quad atan_kernel(const Quad& x) {
  const Quad z = x * x;
  const Quad p = -6.485021904942025371773e1 +
                 z * (-1.228866684490136173410e2 +
                      z * (-7.500855792314704667340e1 +
                           z * (-1.615753718733365076637e1 + z * -8.750608600031904122785e-1)));
  const Quad q = 1.945506571482613964425e2 +
                 z * (4.853903996359136964868e2 +
                      z * (4.328810604912902668951e2 +
                           z * (1.650270098316988542046e2 + z * (2.485846490142306297962e1 + z))));
  return x + x * z * (p / q);
}

// Arc tangent of the smaller over the larger absolute value, then mirrored into the octant.
Quad quad_atan2(const Quad& y, const Quad& x) {
  constexpr double tan_eighth_turn = 0.41421356237309503;  // tan π/8
  constexpr double quarter_pi = 0x1.921fb54442d18p-1, quarter_pi_rest = 0x1.1a62633145c07p-55;
  const Quad zero{};
  const Quad size_x = abs(x), size_y = abs(y);
  const QuadBits steep = size_y > size_x;
  const Quad large = steep ? size_y : size_x, small = steep ? size_x : size_y;
  const QuadBits beyond = small > tan_eighth_turn * large;
  const Quad over = beyond ? small - large : small, under = beyond ? small + large : large;
  const Quad folded = atan_kernel(over / (under == zero ? under + 1.0 : under));
  Quad angle = beyond ? quarter_pi + (folded + quarter_pi_rest) : folded;
  angle = steep ? 2.0 * quarter_pi - (angle - 2.0 * quarter_pi_rest) : angle;
  angle = x < zero ? 4.0 * quarter_pi - (angle - 4.0 * quarter_pi_rest) : angle;
  return y < zero ? -angle : angle;
}

}  // namespace

Lanes atan2(const Lanes& y, const Lanes& x) {
  return {quad_atan2(y.low, x.low), quad_atan2(y.high, x.high)};
}

Lanes sin(const Lanes& x) {
  if (!is_reducible(x)) return each_lane(x, [](double a) { return std::sin(a); });
  return {shifted_sin(x.low, 0), shifted_sin(x.high, 0)};
}

Lanes cos(const Lanes& x) {
  if (!is_reducible(x)) return each_lane(x, [](double a) { return std::cos(a); });
  return {shifted_sin(x.low, 1), shifted_sin(x.high, 1)};
}

Lanes pow(const Lanes& x, double exponent) {
  // Fast paths for the exponents of boundary layers and their derivatives.
  if (exponent == 0.5) return sqrt(x);
  if (exponent == -0.5) return 1.0 / sqrt(x);
  if (exponent == 1.5) return x * sqrt(x);
  return each_lane(x, [exponent](double a) { return std::pow(a, exponent); });
}

}  // namespace photorque
