// Quadrature that estimates its error and refines until it is small.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "core/constants.h"

namespace photorque {

// A value with an estimate of its error, both of one unit.
template <typename Value>
struct Integral {
  Value value;
  double error = 0.0;
};

// Magnitude of an integral: of a number, or the largest of several numbers.
inline double size_of(double value) {
  return std::abs(value);
}
template <typename Derived>
double size_of(const Eigen::ArrayBase<Derived>& values) {
  return values.abs().maxCoeff();
}

// Kronrod's rule with seven nodes on [−1, 1], exact for polynomials of degree 11. It contains
// Gauss's rule with three nodes, exact for degree 5.
// Source: A. S. Kronrod, Nodes and Weights of Quadrature Formulas (1965); D. P. Laurie, Math. Comp.
// 66 (1997), 1133–1145.
inline constexpr std::array<double, 4> kronrod_node = {0.0, 0.434243749346802558,
                                                       0.774596669241483377, 0.960491268708020283};
inline constexpr std::array<double, 4> kronrod_weight = {
    0.450916538658474142, 0.401397414775962223, 0.268488089868333441, 0.104656226026467265};

// ∫ f over [low, high]. The interval is halved until the error is below `tolerance` (> 0), at most
// `depth` times. `f` returns a number or a fixed number of them (Eigen::Array). The error estimate
// is the difference of the two rules, reduced as in QUADPACK because it is the error of the less
// accurate rule.
// Source: R. Piessens et al., QUADPACK (1983), section 3.4.1.
template <typename Function>
auto integrate_adaptively(const Function& f, double low, double high, double tolerance,
                          int depth = 24) {
  using Value = std::decay_t<decltype(f(low))>;
  const double centre = 0.5 * (low + high), half = 0.5 * (high - low);
  std::array<Value, 4> sides;
  const Value middle = f(centre);
  Value kronrod = kronrod_weight[0] * middle;
  for (size_t i = 1; i < 4; ++i) {
    sides[i] = f(centre - half * kronrod_node[i]) + f(centre + half * kronrod_node[i]);
    kronrod += kronrod_weight[i] * sides[i];
  }
  const Value gauss = (8.0 / 9.0) * middle + (5.0 / 9.0) * sides[2];
  double spread = size_of(Value(middle - 0.5 * kronrod)) * kronrod_weight[0];
  for (size_t i = 1; i < 4; ++i) {
    spread += kronrod_weight[i] * size_of(Value(sides[i] - kronrod));
  }
  const double difference = size_of(Value(kronrod - gauss));
  const double ratio = spread > 0.0 ? 200.0 * difference / spread : 0.0;
  const double sharper = spread * ratio * std::sqrt(ratio);
  Integral<Value> result{half * kronrod, std::abs(half) * std::min(difference, sharper)};
  constexpr double rounding = 1e-15, smallest = std::numeric_limits<double>::min();
  const bool exact = result.error <= std::max(rounding * size_of(result.value), smallest);
  if (result.error <= tolerance || exact || depth == 0) return result;
  const auto lower = integrate_adaptively(f, low, centre, 0.5 * tolerance, depth - 1);
  const auto upper = integrate_adaptively(f, centre, high, 0.5 * tolerance, depth - 1);
  return Integral<Value>{lower.value + upper.value, lower.error + upper.error};
}

// ∫ f over [0, π] of a function that is even and periodic (and vanishes at both ends), by the
// trapezoidal rule. The number of steps is doubled until the error is below `tolerance`. Without
// kinks in f the rule converges geometrically; otherwise integrate_adaptively() is used.
// Source: L. N. Trefethen, J. A. C. Weideman, SIAM Review 56 (2014), 385–458.
template <typename Function>
auto integrate_half_turn(const Function& f, double tolerance) {
  using Value = std::decay_t<decltype(f(0.0))>;
  constexpr int most = 64;
  Value sum = f(0.5 * pi);
  Value before = 0.5 * pi * sum;
  for (int steps = 4; steps <= most; steps *= 2) {
    const double step = pi / steps;
    for (int i = 1; i < steps; i += 2) sum += f(i * step);
    const Value now = step * sum;
    const double change = size_of(Value(now - before));
    if (change <= tolerance) return Integral<Value>{now, change};
    before = now;
  }
  return integrate_adaptively(f, 0.0, pi, tolerance);
}

}  // namespace photorque
