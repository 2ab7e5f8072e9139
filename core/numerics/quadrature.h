// Quadrature rules with eight nodes.
#pragma once

#include <array>

namespace photorque {

// ∫ f over [low, high] from four pairs of nodes ±node of [−1, 1] and their weights.
template <typename Function>
double symmetric_rule(const std::array<double, 4>& node, const std::array<double, 4>& weight,
                      const Function& f, double low, double high) {
  const double centre = 0.5 * (low + high);
  const double half = 0.5 * (high - low);
  double sum = 0.0;
  for (size_t i = 0; i < node.size(); ++i) {
    sum += weight[i] * (f(centre - half * node[i]) + f(centre + half * node[i]));
  }
  return half * sum;
}

// Gauss–Legendre: exact for polynomials of degree 15. Inner nodes only.
// Source: M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, table 25.4, n = 8.
template <typename Function>
double gauss_legendre(const Function& f, double low, double high) {
  return symmetric_rule(
      {0.183434642495649805, 0.525532409916328986, 0.796666477413626740, 0.960289856497536232},
      {0.362683783378361983, 0.313706645877887287, 0.222381034453374471, 0.101228536290376259}, f,
      low, high);
}

// Gauss–Lobatto: exact for polynomials of degree 13. Both ends are nodes, so that a step of the
// integrand next to an end, which the inner nodes miss, shows as a difference of the two rules.
// Source: the same, table 25.6, n = 8.
template <typename Function>
double gauss_lobatto(const Function& f, double low, double high) {
  return symmetric_rule(
      {0.209299217902478869, 0.591700181433142302, 0.871740148509606615, 1.0},
      {0.412458794658703882, 0.341122692483504365, 0.210704227143506039, 1.0 / 28.0}, f, low, high);
}

}  // namespace photorque
