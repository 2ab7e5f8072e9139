#include "core/numerics/quadrature.h"

#include <cmath>
#include <vector>

#include "core/constants.h"

namespace photorque {
namespace {

// Newton's iteration on the roots of P_n from Tricomi's starting values.
// Source: W. H. Press et al., Numerical Recipes, 3rd ed. (2007), section 4.6.1; P_n and its
// derivative by the three-term recurrence, NIST DLMF 18.9.1 and 18.9.18.
std::vector<QuadratureNode> make_rule(size_t n) {
  std::vector<QuadratureNode> rule;
  const auto order = static_cast<double>(n);
  for (size_t i = n; i-- > 0;) {
    double x = std::cos(pi * (static_cast<double>(i) + 0.75) / (order + 0.5));
    double slope = 0.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double before = 0.0, value = 1.0;
      for (size_t k = 1; k <= n; ++k) {
        const auto degree = static_cast<double>(k);
        const double next = ((2.0 * degree - 1.0) * x * value - (degree - 1.0) * before) / degree;
        before = value;
        value = next;
      }
      slope = order * (x * value - before) / (x * x - 1.0);
      const double step = value / slope;
      x -= step;
      if (std::abs(step) < 1e-15) break;
    }
    rule.push_back({x, 2.0 / ((1.0 - x * x) * slope * slope)});
  }
  return rule;
}

std::vector<std::vector<QuadratureNode>> make_rules() {
  std::vector<std::vector<QuadratureNode>> rules;
  for (size_t n = 1; n <= max_gauss_nodes; ++n) rules.push_back(make_rule(n));
  return rules;
}

}  // namespace

std::span<const QuadratureNode> gauss_legendre(size_t n) {
  static const std::vector<std::vector<QuadratureNode>> rules = make_rules();
  return rules[n - 1];
}

// With c_0² = m and c_{n+1} = (a_n − b_n)/2 = c_n²/(4 a_{n+1}), E = K (1 − Σ 2^{n−1} c_n²). The
// terms from n = 1 on, `rest`, are computed without cancellation for small m.
EllipticIntegrals complete_elliptic(double m, double complement) {
  double a = 1.0, b = std::sqrt(complement);
  double c = 0.5 * m / (1.0 + b);  // (1 − b)/2
  double weight = 1.0, rest = 0.0;
  for (int n = 1; n < 60; ++n) {
    const double next_a = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = next_a;
    rest += weight * c * c;
    if (c <= 1e-17 * a) break;
    c = c * c / (2.0 * (a + b));
    weight *= 2.0;
  }
  EllipticIntegrals integrals;
  integrals.first = pi / (2.0 * a);
  integrals.second = integrals.first * (1.0 - 0.5 * m - rest);
  integrals.potential = integrals.first * rest;
  integrals.radial = integrals.first * (0.25 * m * m - (1.0 - 0.5 * m) * rest) / complement;
  return integrals;
}

}  // namespace photorque
