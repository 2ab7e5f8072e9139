// A root of a falling function that cannot fail.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace photorque {

struct FunctionAt {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;  // 0 where it is not known: only the speed depends on it
  double third = std::numeric_limits<double>::quiet_NaN();  // NaN where it is not known
  // Whether the derivatives describe the function as far as the root; the search does not end
  // before. On a straight stretch they do not tell where it ends.
  bool close = true;
};

// One step towards the root: the inverse function's series as far as derivatives are known.
struct RootStep {
  double length = 0.0;
  double left = 0.0;  // estimate of the error after it; ∞ without third derivative
};

inline RootStep root_step(const FunctionAt& f) {
  const double inverse_slope = 1.0 / f.slope;
  const double newton = f.value * inverse_slope;
  const double bend = 0.5 * newton * f.curvature * inverse_slope;
  const double chebyshev = newton * (std::abs(bend) < 0.5 ? 1.0 + bend : 1.0);
  if (std::isnan(f.third)) return {-chebyshev, std::numeric_limits<double>::infinity()};
  const double twist = newton * newton * f.third * inverse_slope / 6.0;
  const double q2 = std::max(bend * bend, std::abs(twist));
  // The next term is of third order in q; third derivatives are good to 1e-3.
  const double left = std::abs(newton) * q2 * (std::sqrt(q2) + 2e-3);
  return {q2 < 0.09 ? -newton * (1.0 + bend + 2.0 * bend * bend - twist) : -chebyshev, left};
}

// The root of a falling function on [low, high], where it is ≥ 0 at low and ≤ 0 at high (rounding
// aside). From `guess` (the middle where it is not finite), Newton's method with the terms of
// second and third order; bisection whenever a step leaves the bracket or is not half the one
// before. Ends with a step that is at most `tolerance`·|x|, and applies it: the error left is of
// third order in it with the curvature, of second order without. Where third derivatives are known,
// it must also be below 1e-12·|x| by estimate, so that `tolerance` may be large: the function is
// then evaluated no more than needed.
template <typename Function>
double falling_root(double low, double high, double guess, double tolerance, Function&& function) {
  double x = std::isfinite(guess) ? std::max(low, std::min(guess, high)) : std::midpoint(low, high);
  double last_step = high - low;
  const double min_step = std::numeric_limits<double>::min() + 1e-17 * last_step;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const FunctionAt f = function(x);
    if (f.value == 0.0) return x;
    (f.value > 0 ? low : high) = x;
    const RootStep step = root_step(f);
    double next = x + step.length;
    const bool bisected = !(next >= low && next <= high) || std::abs(step.length) > 0.5 * last_step;
    if (bisected) next = std::midpoint(low, high);
    last_step = std::abs(next - x);
    const bool exact = std::isnan(f.third) || last_step <= 1e-13 * std::abs(x) ||
                       (!bisected && step.left <= 1e-12 * std::abs(x));
    if ((f.close && exact && last_step <= tolerance * std::abs(x)) || last_step <= min_step) {
      return next;
    }
    x = next;
  }
  return x;
}

}  // namespace photorque
