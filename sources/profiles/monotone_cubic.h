// Slopes for a cubic Hermite interpolant that rises and falls only where its data do.
#pragma once

#include <span>
#include <vector>

namespace photorque {

// dy/dx at every knot: the derivative of the polynomial through the (up to) five nearest knots,
// cut to what keeps the interpolant monotone between knots. Smooth data are met to fourth order in
// the spacing; the interpolant never leaves the range of the two values around it. `x` strictly
// ascending, at least two knots; both of one length.
// Source of the bound |slope| ≤ 3 |chord|: F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17
// (1980) 238; of high-order slopes under it: J. M. Hyman, SIAM J. Sci. Stat. Comput. 4 (1983) 645.
std::vector<double> monotone_slopes(std::span<const double> x, std::span<const double> y);

// The value in the middle of knots `i` and `i + 1`: of the polynomial through the (up to) six
// nearest knots, kept between 1/8 and 7/8 of the way from one value to the other, which is where
// monotone cubics can have it. Smooth data are met to sixth order in the spacing. On steep flanks,
// where one value is twice the other or more, the polynomial goes through the logarithms, because
// beams fall off like exponentials; not where a value is zero or a hundred times its neighbour.
double monotone_middle(std::span<const double> x, std::span<const double> y, size_t i);

// The cubic on [0, width] with these values and slopes at its ends, at `t` ∈ [0, 1].
inline double hermite(double width, double low, double slope_low, double high, double slope_high,
                      double t) {
  const double a = slope_low * width, b = slope_high * width, rise = high - low;
  return low + t * (a + t * (3.0 * rise - 2.0 * a - b + t * (a + b - 2.0 * rise)));
}

}  // namespace photorque
