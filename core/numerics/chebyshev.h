// Smooth functions by their values at Chebyshev points.
#pragma once

#include <cstddef>

#include "core/vector.h"

namespace photorque {

// Point i of n Chebyshev points of the first kind on [0, 1].
double chebyshev_fraction(size_t n, size_t i);

// Row c gives the mean over the c-th of `cells` even parts of [0, 1] of the polynomial through
// values at the n points, as weights of these values.
Eigen::MatrixXd chebyshev_cell_means(size_t n, size_t cells);

}  // namespace photorque
