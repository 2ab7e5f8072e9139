// Interpolation: Chebyshev series, monotone cubics.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/transform.h"

namespace photorque {

// Point i of n Chebyshev points of the first kind, in descending order on [−1, 1]: cos π (i + ½)/n.
double chebyshev_point(size_t n, size_t i);
// The Chebyshev point i in ascending order on [0, 1].
double chebyshev_fraction(size_t n, size_t i);

// Weight of the value at the Chebyshev point cos `angle_rad` of n in the coefficient of T_k of the
// polynomial through all values, by the discrete orthogonality of T_k on the points.
// Source: NIST DLMF 3.11.24 and 18.3.
double chebyshev_weight(size_t n, size_t k, double angle_rad);

// Row k contains the weights of values at the n points, in ascending order, that give the
// coefficient of T_k on [0, 1] of the polynomial through these values.
Eigen::MatrixXd chebyshev_coefficients(size_t n);

// Row c contains the means of T_0 … T_{n − 1} on [0, 1] over the c-th of `cells` equal parts of [0,
// 1].
Eigen::MatrixXd chebyshev_term_means(size_t n, size_t cells);

// Cubic Hermite interpolation, and slopes with which the interpolant is monotone wherever its data
// are.

// dy/dx at every knot: the derivative of the polynomial through the (up to) five nearest knots,
// limited so that the interpolant is monotone between knots. For smooth data the error is of fourth
// order in the spacing. The interpolant never leaves the range of the two adjacent values. `x` must
// be strictly ascending, with at least two knots; `x` and `y` have equal lengths. Source of the
// bound |slope| ≤ 3 |chord|: F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17 (1980) 238; of
// high-order slopes within it: J. M. Hyman, SIAM J. Sci. Stat. Comput. 4 (1983) 645.
std::vector<double> monotone_slopes(std::span<const double> x, std::span<const double> y);

// The value halfway between knots `i` and `i + 1`: that of the polynomial through the (up to) six
// nearest knots. It is limited to between 1/8 and 7/8 of the way from one value to the other, the
// range of monotone cubics. For smooth data the error is of sixth order in the spacing. On steep
// flanks, where one value is at least twice the other, the polynomial goes through the logarithms,
// because beams fall off like exponentials. It goes through the values if one of them is zero or a
// hundred times its neighbour.
double monotone_middle(std::span<const double> x, std::span<const double> y, size_t i);

// The cubic of t ∈ [0, 1] from `low` to `low + rise` with these slopes dy/dt at its ends, as
// coefficients of 1, t, t², t³.
inline std::array<double, 4> hermite_coefficients(double low, double rise, double slope_low,
                                                  double slope_high) {
  return {low, slope_low, 3.0 * rise - 2.0 * slope_low - slope_high,
          slope_low + slope_high - 2.0 * rise};
}

// The cubic on [0, width] with these values and slopes at its ends, at `t` ∈ [0, 1] of the width.
inline double hermite(double width, double low, double slope_low, double high, double slope_high,
                      double t) {
  const auto c = hermite_coefficients(low, high - low, slope_low * width, slope_high * width);
  return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
}

}  // namespace photorque
