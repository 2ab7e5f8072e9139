#include "core/estimate.h"

#include <cmath>

namespace photorque {

Estimate estimate_from_replicates(std::span<const double> replicates) {
  const double count = static_cast<double>(replicates.size());
  double sum = 0.0;
  for (const double x : replicates) sum += x;
  const double mean = sum / count;
  double squares = 0.0;
  for (const double x : replicates) squares += (x - mean) * (x - mean);
  return {mean, std::sqrt(squares / (count * (count - 1.0)))};
}

double student_t_975(int replicates) {
  // Hill's asymptotic expansion is not accurate below 3 degrees of freedom, so those are tabulated
  // (Abramowitz & Stegun, table 26.10); above it A&S 26.7.5 is good to 1e-3.
  const int degrees = replicates - 1;
  if (degrees <= 1) return 12.706;
  if (degrees == 2) return 4.303;
  const double x = 1.959963985, n = degrees;
  const double x3 = x * x * x, x5 = x3 * x * x, x7 = x5 * x * x;
  return x + (x3 + x) / (4 * n) + (5 * x5 + 16 * x3 + 3 * x) / (96 * n * n) +
         (3 * x7 + 19 * x5 + 17 * x3 - 15 * x) / (384 * n * n * n);
}

}  // namespace photorque
