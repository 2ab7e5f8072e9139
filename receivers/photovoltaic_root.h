// A root of a falling function that cannot fail.
#pragma once

#include <cmath>
#include <limits>
#include <numeric>

namespace photorque {

struct ValueAndSlope {
  double value = 0.0;
  double slope = 0.0;
};

// The root of a falling function on [low, high], where it is ≥ 0 at low and ≤ 0 at high (rounding
// aside). Newton's method from `guess`; bisection whenever a step leaves the bracket or is not half
// the one before. Stops with the step that is at most `tolerance`·|x|, and applies it: the error
// left is of second order in it.
template <typename Function>
double falling_root(double low, double high, double guess, double tolerance, Function&& function) {
  double x = guess > low && guess < high ? guess : std::midpoint(low, high);
  double last_step = high - low;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const ValueAndSlope f = function(x);
    if (f.value == 0.0) return x;
    (f.value > 0 ? low : high) = x;
    double next = x - f.value / f.slope;
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
