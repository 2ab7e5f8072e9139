// A root of a falling function that cannot fail.
#pragma once

#include <cmath>
#include <limits>
#include <numeric>

namespace photorque {

struct FunctionAt {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;  // 0 where it is not known: only the speed depends on it
};

// The root of a falling function on [low, high], where it is ≥ 0 at low and ≤ 0 at high (rounding
// aside). From `guess`, Newton's method with Chebyshev's second-order term; bisection whenever a
// step leaves the bracket or is not half the one before. Stops with the step that is at most
// `tolerance`·|x|, and applies it: the error left is of third order in it with the curvature, of
// second order without.
template <typename Function>
double falling_root(double low, double high, double guess, double tolerance, Function&& function) {
  double x = guess > low && guess < high ? guess : std::midpoint(low, high);
  double last_step = high - low;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const FunctionAt f = function(x);
    if (f.value == 0.0) return x;
    (f.value > 0 ? low : high) = x;
    const double inverse_slope = 1.0 / f.slope;
    const double newton = f.value * inverse_slope;
    const double bend = 0.5 * newton * f.curvature * inverse_slope;
    double next = x - newton * (std::abs(bend) < 0.5 ? 1.0 + bend : 1.0);
    if (!(next >= low && next <= high) || std::abs(next - x) > 0.5 * last_step) {
      next = std::midpoint(low, high);
    }
    last_step = std::abs(next - x);
    if (last_step <= tolerance * std::abs(x) || last_step <= std::numeric_limits<double>::min()) {
      return next;
    }
    x = next;
  }
  return x;
}

}  // namespace photorque
