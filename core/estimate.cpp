#include "core/estimate.h"

#include <algorithm>
#include <array>
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
  // Abramowitz & Stegun, table 26.10; from 6 degrees of freedom on, their expansion 26.7.5 is good
  // to 1e-3.
  constexpr std::array tabulated = {12.706, 4.303, 3.182, 2.776, 2.571};
  const int degrees = replicates - 1;
  if (degrees <= static_cast<int>(tabulated.size())) {
    return tabulated[static_cast<size_t>(std::max(degrees, 1) - 1)];
  }
  const double x = 1.959963985, n = degrees;
  const double x3 = x * x * x, x5 = x3 * x * x, x7 = x5 * x * x;
  return x + (x3 + x) / (4 * n) + (5 * x5 + 16 * x3 + 3 * x) / (96 * n * n) +
         (3 * x7 + 19 * x5 + 17 * x3 - 15 * x) / (384 * n * n * n);
}

}  // namespace photorque
