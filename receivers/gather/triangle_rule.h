// The mean of a function over a triangle. For the files of this folder and below only.
#pragma once

namespace photorque {

// The sum over the three points (a, b) as near to the corners of the triangle.
template <typename Function>
auto triangle_ring(const Function& f, double near) {
  const double far = 1.0 - 2.0 * near;
  auto sum = f(near, near);
  sum += f(far, near);
  sum += f(near, far);
  return sum;
}

// The mean over the triangle a, b ≥ 0, a + b ≤ 1, by the rule of degree 5 with seven points.
// Source: A. H. Stroud, Approximate Calculation of Multiple Integrals (1971), T2: 5-1.
template <typename Function>
auto triangle_mean(const Function& f) {
  constexpr double inner = 0.47014206410511509, inner_weight = 0.13239415278850618;
  constexpr double outer = 0.10128650732345634, outer_weight = 0.12593918054482715;
  constexpr double third = 1.0 / 3.0;
  auto mean = f(third, third);
  mean *= 0.225;
  mean += inner_weight * triangle_ring(f, inner);
  mean += outer_weight * triangle_ring(f, outer);
  return mean;
}

}  // namespace photorque
