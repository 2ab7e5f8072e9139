// The way back to the bounds of parameters that were fitted without them.
#pragma once

#include <Eigen/Core>

#include "inference/estimator/arrow_matrix.h"
#include "inference/estimator/parameter.h"

namespace photorque::inference {

// The step δ from the optimum `at` to within the bounds of all parameters by which χ² grows least:
// min δᵀ H δ with lowest ≤ θ + δ ≤ highest, H the information there, positive definite. What is
// correlated moves along: to bring one of several numbers back whose sum alone is ill known, all of
// them move. Zero where nothing is beyond a bound. By an active set (Nocedal & Wright, Numerical
// Optimization, 2nd ed. 2006, section 16.5).
Eigen::VectorXd step_to_bounds(const ArrowMatrix& information, const Parameters& at);

}  // namespace photorque::inference
