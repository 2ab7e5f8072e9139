// Gauss collocation with eight points on [0, 1], and its Legendre polynomials, evaluated at compile
// time.
//
// Source: E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2nd ed. (2006), II.1.
#pragma once

#include <array>

#include "core/numerics/lanes.h"
#include "core/numerics/quadrature.h"

namespace photorque::gauss {

inline constexpr int points = Lanes::count;
using Row = std::array<double, points>;

constexpr Row make_nodes() {
  Row c{};
  for (size_t i = 0; i < 4; ++i) {
    c[4 + i] = 0.5 + 0.5 * gauss_8.node[i];
    c[3 - i] = 0.5 - 0.5 * gauss_8.node[i];
  }
  return c;
}
constexpr Row make_weights() {
  Row b{};
  for (size_t i = 0; i < 4; ++i) b[4 + i] = b[3 - i] = 0.5 * gauss_8.weight[i];
  return b;
}
inline constexpr Row nodes = make_nodes();
inline constexpr Row weights = make_weights();

// P_0 … P_8 of 2x − 1 for a number or lanes x.
template <class T>
constexpr std::array<T, points + 1> legendre(const T& x) {
  std::array<T, points + 1> p{};
  const T u = T(2.0) * x - T(1.0);
  p[0] = T(1.0);
  p[1] = u;
  for (int k = 1; k < points; ++k) {
    p[k + 1] = (T(2.0 * k + 1.0) * u * p[k] - T(static_cast<double>(k)) * p[k - 1]) / T(k + 1.0);
  }
  return p;
}

// ∫₀ˣ P_k(2u − 1) du for k = 0 … 7.
template <class T>
constexpr std::array<T, points> legendre_integrals(const T& x) {
  const std::array<T, points + 1> p = legendre(x);
  std::array<T, points> integral{};
  integral[0] = x;
  for (int k = 1; k < points; ++k) {
    integral[k] = (p[k + 1] - p[k - 1]) / T(2.0 * (2.0 * k + 1.0));
  }
  return integral;
}

// The matrix μ_ij = a_ij / b_j of the method, with μ_ij + μ_ji = 1 exactly. With increments h b_j
// f_j it conserves quadratic invariants (norm, energy and angular momentum of a free body) to
// rounding.
// Source: M. Antoñana, J. Makazaga, A. Murua, "Reducing and monitoring round-off error propagation
// for symplectic implicit Runge-Kutta schemes", Numer. Algorithms 76 (2017), section 3.2.
// Stored by columns: column j holds μ_ij for all stages i.
constexpr std::array<Row, points> make_mu_columns() {
  std::array<Row, points> column{};
  for (int i = 0; i < points; ++i) {
    const std::array<double, points> integral = legendre_integrals(nodes[i]);
    for (int j = 0; j < points; ++j) {
      const std::array<double, points + 1> p = legendre(nodes[j]);
      double sum = 0.0;
      for (int k = 0; k < points; ++k) sum += (2.0 * k + 1.0) * p[k] * integral[k];
      column[j][i] = sum;
    }
  }
  for (int i = 0; i < points; ++i) {
    column[i][i] = 0.5;
    for (int j = 0; j < i; ++j) column[i][j] = 1.0 - column[j][i];
  }
  return column;
}
inline constexpr std::array<Row, points> mu_columns = make_mu_columns();

// Row k gives the k-th Legendre coefficient of a polynomial from its increments b_j f_j.
constexpr std::array<Row, points> make_projection() {
  std::array<Row, points> row{};
  for (int j = 0; j < points; ++j) {
    const std::array<double, points + 1> p = legendre(nodes[j]);
    for (int k = 0; k < points; ++k) row[k][j] = (2.0 * k + 1.0) * p[k];
  }
  return row;
}
inline constexpr std::array<Row, points> projection = make_projection();

// Columns j of the matrix that extrapolates the increments h b_j f_j of a step to a next step that
// is `ratio` times as long. Exact for polynomials of degree 7.
inline std::array<Row, points> continuation_columns(double ratio) {
  std::array<Row, points> column{};
  for (int i = 0; i < points; ++i) {
    const std::array<double, points + 1> p = legendre(1.0 + ratio * nodes[i]);
    for (int j = 0; j < points; ++j) {
      double sum = 0.0;
      for (int k = 0; k < points; ++k) sum += p[k] * projection[k][j];
      column[j][i] = ratio * weights[i] * sum;
    }
  }
  return column;
}

// The product of a matrix, given by its columns, with x: Σ_j column_j x_j.
inline Lanes times(const std::array<Row, points>& columns, const Lanes& x) {
  // Two independent chains of additions, which the processor can overlap.
  Lanes even = Lanes(columns[0]) * x[0];
  Lanes odd = Lanes(columns[1]) * x[1];
  for (int j = 2; j < points; j += 2) {
    even += Lanes(columns[j]) * x[j];
    odd += Lanes(columns[j + 1]) * x[j + 1];
  }
  return even + odd;
}

// Weights of the increments in the polynomial at fractions θ of the step: y(θ) = y + Σ_j w_j(θ)
// x_j, one set of lanes per increment.
using DenseWeights = std::array<Lanes, points>;
inline DenseWeights dense_weights(const Lanes& fraction) {
  const std::array<Lanes, points> integral = legendre_integrals(fraction);
  DenseWeights weight;
  for (int j = 0; j < points; ++j) {
    weight[j] = 0.0;
    for (int k = points - 1; k >= 0; --k) weight[j] += projection[k][j] * integral[k];
  }
  return weight;
}
inline Lanes times(const DenseWeights& dense, const Lanes& x) {
  Lanes sum = dense[0] * x[0];
  for (int j = 1; j < points; ++j) sum += dense[j] * x[j];
  return sum;
}

}  // namespace photorque::gauss
