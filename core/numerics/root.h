// Roots inside a bracket, by methods that always converge: bisection, Newton's method limited to
// the bracket, and a method of third order for falling functions with known curvature.
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
  double relative_width = 0.0;  // fraction of |high|
};

// Halves [low, high] until the bracket is as narrow as `end` requires or its ends are neighbouring
// numbers. `is_below(x)` returns whether x lies below the root.
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
  double length;  // Newton's step from x; 0: x is the root
};

// The root between `low` and `high` by Newton's method from x. A step that leaves the bracket, or
// is longer than half of the previous one, is replaced by bisection. Ends with a step of at most
// `tolerance`·|x|.
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
  double curvature = 0.0;  // 0 if unknown: it affects only the speed
  double third = std::numeric_limits<double>::quiet_NaN();  // NaN if unknown
  // Whether the derivatives describe the function as far as the root. The search does not end while
  // this is false, because derivatives on a straight part do not show where that part ends.
  bool close = true;
};

// One step towards the root, of a number or of lanes: the series of the inverse function up to the
// known derivatives.
template <class T>
struct RootStep {
  T length;
  T left;  // estimate of the remaining error; ∞ without third derivative
};

// Chebyshev's method: Newton's step with the term of f″, if that term is small enough to be
// accurate.
// Source: J. F. Traub, Iterative Methods for the Solution of Equations (1964), section 5.1.
template <class T>
T second_order_length(const T& newton, const T& bend) {
  using photorque::abs;
  using std::abs;
  return -newton * select(abs(bend) < 0.5, 1.0 + bend, 1.0 + T{});
}

// Step with derivatives up to the third one. If its terms are too large, second_order_length() is
// used.
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
  // The next term is of third order in q; third derivatives are accurate to 1e-3.
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

// The root of a falling function on [low, high], which is ≥ 0 at low and ≤ 0 at high (except for
// rounding). The search starts from `guess`, or from the middle if that is not finite. It is
// Newton's method with the terms of second and third order. A step that leaves the bracket, or is
// longer than half of the previous one, is replaced by bisection. The search ends with a step of at
// most `tolerance`·|x|, which is applied: the remaining error is of third order in this step with
// the curvature, of second order without. If third derivatives are known, the estimated error must
// also be below 1e-12·|x|. `tolerance` may then be large, which saves evaluations of the function.
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
