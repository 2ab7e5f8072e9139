// A number that was estimated, with its standard error.
#pragma once

#include <span>

namespace photorque {

// `standard_error` is one standard deviation of `value`, in the same unit; 0 for exact values.
struct Estimate {
  double value = 0.0;
  double standard_error = 0.0;
};

// Mean and its standard error from independent, identically distributed replicates, at least two.
// With R replicates the error itself is uncertain by about 1/√(2(R−1)).
// Source: W. G. Cochran, Sampling Techniques, 3rd ed., eq. 2.20 (without finite correction).
Estimate estimate_from_replicates(std::span<const double> replicates);

// The two-sided 97.5 % quantile of Student's t with `replicates`−1 degrees of freedom: the 95 %
// interval of an Estimate is value ± this · standard_error.
double student_t_975(int replicates);

}  // namespace photorque
