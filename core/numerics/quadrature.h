// Quadrature by the rules of Gauss, Legendre and Lobatto; complete elliptic integrals.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace photorque {

// The positive half of a rule of eight nodes ±x on [−1, 1]; both nodes of a pair have one weight.
struct EightPointRule {
  std::array<double, 4> node, weight;
};

// Gauss–Legendre: exact for polynomials of degree 15. Inner nodes only.
// Source: NIST Digital Library of Mathematical Functions, table 3.5.2, n = 8.
inline constexpr EightPointRule gauss_8 = {{0.18343464249564980494, 0.52553240991632898582,
                                            0.79666647741362673959, 0.96028985649753623168},
                                           {0.36268378337836198297, 0.31370664587788728734,
                                            0.22238103445337447054, 0.10122853629037625915}};

// Gauss–Lobatto: exact for polynomials of degree 13. Both ends are nodes. A step of the integrand
// next to an end, which inner nodes miss, therefore appears as a difference between the two rules.
// Source: M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, table 25.6, n = 8.
inline constexpr EightPointRule lobatto_8 = {
    {0.209299217902478869, 0.591700181433142302, 0.871740148509606615, 1.0},
    {0.412458794658703882, 0.341122692483504365, 0.210704227143506039, 1.0 / 28.0}};

// Σ w f over the nodes of a rule on [centre − half, centre + half]. The integral is this sum times
// `half`. Inlined, so that the numbers of the rule are constants of the loop.
template <typename Function>
[[gnu::always_inline]] inline double weighted_sum(const EightPointRule& rule, const Function& f,
                                                  double centre, double half) {
  double sum = 0.0;
  for (size_t i = 0; i < rule.node.size(); ++i) {
    sum += rule.weight[i] * (f(centre - half * rule.node[i]) + f(centre + half * rule.node[i]));
  }
  return sum;
}

// ∫ f over [low, high].
template <typename Function>
double integrate(const EightPointRule& rule, const Function& f, double low, double high) {
  const double half = 0.5 * (high - low);
  return half * weighted_sum(rule, f, 0.5 * (low + high), half);
}

// Integral over [low, high] by the rule in each of `panels` equal parts.
template <typename Function>
double integrate(const EightPointRule& rule, const Function& f, double low, double high,
                 int panels) {
  const double half = 0.5 * (high - low) / panels;
  double sum = 0.0;
  for (int k = 0; k < panels; ++k) sum += weighted_sum(rule, f, low + (2 * k + 1) * half, half);
  return half * sum;
}

struct QuadratureNode {
  double x;  // in (−1, 1)
  double weight;
};

inline constexpr size_t max_gauss_nodes = 64;

// The Gauss–Legendre rule of n nodes, 1 ≤ n ≤ max_gauss_nodes, in ascending order; exact for
// polynomials of degree 2n − 1, to rounding.
std::span<const QuadratureNode> gauss_legendre(size_t n);

// Complete elliptic integrals by the arithmetic-geometric mean.

struct EllipticIntegrals {
  double first = 0.0;   // K(m)
  double second = 0.0;  // E(m)
  // Combinations of K and E, computed here without the cancellation for small m:
  double potential = 0.0;  // (1 − m/2) K − E, ~ π m²/32
  double radial = 0.0;     // (1 − m/2)/(1 − m) E − K, ~ 3 π m²/32
};

// For the parameter m = k² in [0, 1). The complement 1 − m is an argument too, because it would
// lose digits near m = 1. Relative error a few 1e-16 (of `first` and `potential` near m = 1 too).
// Source: M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 17.6.3–17.6.4.
EllipticIntegrals complete_elliptic(double m, double complement);

}  // namespace photorque
