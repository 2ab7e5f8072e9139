#include "core/numerics/elliptic.h"

#include <cmath>

#include "core/constants.h"

namespace photorque {

// With c_0² = m and c_{n+1} = (a_n − b_n)/2 = c_n²/(4 a_{n+1}), E = K (1 − Σ 2^{n−1} c_n²). The
// terms from n = 1 on, `rest`, are small for small m without a difference being taken.
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
