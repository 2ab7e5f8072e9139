// Interpolation: Chebyshev series, monotone cubics.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/transform.h"

namespace photorque {

// Point i of n Chebyshev points of the first kind, falling on [−1, 1]: cos π (i + ½)/n.
double chebyshev_point(size_t n, size_t i);
// The Chebyshev point, rising on [0, 1].
double chebyshev_fraction(size_t n, size_t i);

// By how much the value at the point cos `angle_rad` of n enters the coefficient of T_k of the
// polynomial through all values, by the discrete orthogonality of T_k on the points.
// Source: NIST DLMF 3.11.24 and 18.3.
double chebyshev_weight(size_t n, size_t k, double angle_rad);

// Row k gives the coefficient of T_k on [0, 1] of the polynomial through values at the n points,
// rising, as weights of these values.
Eigen::MatrixXd chebyshev_coefficients(size_t n);

// Row c gives the means over the c-th of `cells` even parts of [0, 1] of T_0 … T_{n − 1} of [0, 1].
Eigen::MatrixXd chebyshev_term_means(size_t n, size_t cells);

// Cubic Hermite interpolation, and slopes for it with which it rises and falls only where its data
// do.

// dy/dx at every knot: the derivative of the polynomial through the (up to) five nearest knots,
// limited so that the interpolant is monotone between knots. Smooth data are met to fourth order in
// the spacing; the interpolant never leaves the range of the two values around it. `x` strictly
// ascending, at least two knots; both of one length. Source of the bound |slope| ≤ 3 |chord|: F. N.
// Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17 (1980) 238; of high-order slopes under it: J. M.
// Hyman, SIAM J. Sci. Stat. Comput. 4 (1983) 645.
std::vector<double> monotone_slopes(std::span<const double> x, std::span<const double> y);

// The value in the middle of knots `i` and `i + 1`: of the polynomial through the (up to) six
// nearest knots, kept between 1/8 and 7/8 of the way from one value to the other, which is where
// monotone cubics can have it. Smooth data are met to sixth order in the spacing. On steep flanks,
// where one value is twice the other or more, the polynomial goes through the logarithms, because
// beams fall off like exponentials; not where a value is zero or a hundred times its neighbour.
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
