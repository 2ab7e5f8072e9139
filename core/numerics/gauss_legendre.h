// Gauss–Legendre rules of any small order.
#pragma once

#include <cstddef>
#include <span>

namespace photorque {

struct QuadratureNode {
  double x;  // in (−1, 1)
  double weight;
};

inline constexpr size_t max_gauss_nodes = 64;

// The rule of n nodes, 1 ≤ n ≤ max_gauss_nodes, rising; exact for polynomials of degree 2n − 1.
std::span<const QuadratureNode> gauss_legendre(size_t n);

}  // namespace photorque
