// How one coordinate of a recording begins.
#pragma once

#include "attitude/observation/observation.h"

namespace photorque {

struct FirstLine {
  double value = 0.0, slope_1_s = 0.0;  // at the time of the run's first block; of the unit per s
};

// The line of least squares through the first `most` blocks that have a reading; of one alone its
// value; zero where the run has none.
inline FirstLine first_line(const Observation& seen, Scalar scalar, int most) {
  if (!seen.has(scalar)) return {};
  const ScalarReadings& read = seen.scalar[static_cast<size_t>(scalar)];
  double n = 0.0, t = 0.0, x = 0.0, tt = 0.0, tx = 0.0;
  for (size_t i = 0; i < read.rows.size() && n < most; ++i) {
    if (!(read.rows[i] > 0.0)) continue;
    const double since_s = seen.time_s[i] - seen.time_s.front();
    n += 1.0;
    t += since_s;
    x += read.value[i];
    tt += since_s * since_s;
    tx += since_s * read.value[i];
  }
  const double spread = n * tt - t * t;
  if (!(spread > 0.0)) return {n > 0.0 ? x / n : 0.0};
  const double slope_1_s = (n * tx - t * x) / spread;
  return {(x - slope_1_s * t) / n, slope_1_s};
}

}  // namespace photorque
