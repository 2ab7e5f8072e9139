// Roots inside a bracket, by searches that cannot fail: bisection, Newton's method kept inside the
// bracket, and for falling functions with known curvature a method of third order.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/numerics/quad.h"

namespace photorque {

struct RootBracket {
  double low, high;

  double middle() const { return std::midpoint(low, high); }
};

struct BisectionEnd {
  int max_rounds = 200;
  double relative_width = 0.0;  // of |high|
};

// Halves [low, high], where `is_below(x)` is whether x lies below the root, until the bracket is as
// narrow as `end` asks for or its ends are neighbouring numbers.
template <typename Predicate>
RootBracket bisect(double low, double high, const Predicate& is_below, BisectionEnd end = {}) {
  for (int round = 0; round < end.max_rounds; ++round) {
    const double middle = std::midpoint(low, high);
    if (middle == low || middle == high) break;
    if (high - low <= end.relative_width * std::abs(high)) break;
    (is_below(middle) ? low : high) = middle;
  }
  return {low, high};
}

// The values of a function at x that newton_root() needs.
struct NewtonStep {
  bool is_below;  // x lies below the root
  double length;  // from x to where Newton's method leads; 0: x is the root
};

// The root between `low` and `high` from the start x, by Newton's method; bisection whenever a step
// leaves the bracket or is not half the one before. Ends with a step of at most `tolerance`·|x|.
template <typename Function>
double newton_root(double low, double high, double x, double tolerance, const Function& step_at) {
  double last_step = high - low;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const NewtonStep step = step_at(x);
    if (step.length == 0.0) return x;
    (step.is_below ? low : high) = x;
    double next = x + step.length;
    if (!(next > low && next < high) || std::abs(next - x) > 0.5 * last_step) {
      next = std::midpoint(low, high);
    }
    last_step = std::abs(next - x);
    x = next;
    if (last_step <= tolerance * std::abs(x)) break;
  }
  return x;
}

struct FunctionAt {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;  // 0 where it is not known: only the speed depends on it
  double third = std::numeric_limits<double>::quiet_NaN();  // NaN where it is not known
  // Whether the derivatives describe the function as far as the root; the search does not end
  // before. On a straight part they do not show where it ends.
  bool close = true;
};

// One step towards the root of a number or of lanes: the inverse function's series as far as
// derivatives are known.
template <class T>
struct RootStep {
  T length;
  T left;  // estimate of the error after it; ∞ without third derivative
};

// With f″ where its term is small enough to be trusted: Chebyshev's method.
// Source: J. F. Traub, Iterative Methods for the Solution of Equations (1964), section 5.1.
template <class T>
T second_order_length(const T& newton, const T& bend) {
  using photorque::abs;
  using std::abs;
  return -newton * select(abs(bend) < 0.5, 1.0 + bend, 1.0 + T{});
}

template <class T>
RootStep<T> third_order_step(const T& value, const T& slope, const T& curvature, const T& third) {
  using photorque::abs;
  using photorque::max;
  using photorque::sqrt;
  using std::abs;
  using std::max;
  using std::sqrt;
  const T inverse_slope = 1.0 / slope;
  const T newton = value * inverse_slope;
  const T bend = 0.5 * newton * curvature * inverse_slope;
  const T twist = newton * newton * third * inverse_slope / 6.0;
  const T q2 = max(bend * bend, abs(twist));
  // The next term is of third order in q; third derivatives are good to 1e-3.
  const T left = abs(newton) * q2 * (sqrt(q2) + 2e-3);
  return {select(q2 < 0.09, -newton * (1.0 + bend + 2.0 * bend * bend - twist),
                 second_order_length(newton, bend)),
          left};
}

inline RootStep<double> root_step(const FunctionAt& f) {
  if (!std::isnan(f.third)) return third_order_step(f.value, f.slope, f.curvature, f.third);
  const double inverse_slope = 1.0 / f.slope;
  const double newton = f.value * inverse_slope;
  return {second_order_length(newton, 0.5 * newton * f.curvature * inverse_slope),
          std::numeric_limits<double>::infinity()};
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
    const RootStep<double> step = root_step(f);
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
