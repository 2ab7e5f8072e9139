// Smooth functions by their values at Chebyshev points.
#pragma once

#include <cstddef>

#include "core/vector.h"

namespace photorque {

// Point i of n Chebyshev points of the first kind, falling on [−1, 1]: cos π (i + ½)/n.
double chebyshev_point(size_t n, size_t i);
// The same, rising on [0, 1].
double chebyshev_fraction(size_t n, size_t i);

// By how much the value at the point cos `angle_rad` of n enters the coefficient of T_k of the
// polynomial through all values, by the discrete orthogonality of T_k on the points.
// Source: NIST DLMF 3.11.24 and 18.3.
double chebyshev_weight(size_t n, size_t k, double angle_rad);

// Row k gives the coefficient of T_k on [0, 1] of the polynomial through values at the n points,
// rising, as weights of these values.
Eigen::MatrixXd chebyshev_coefficients(size_t n);

// Row c gives the mean over the c-th of `cells` even parts of [0, 1] of the polynomial through
// values at the n points, as weights of these values.
Eigen::MatrixXd chebyshev_cell_means(size_t n, size_t cells);

}  // namespace photorque
