// The error of powers that count rays.
#pragma once

#include <cmath>

#include "raytrace/tracing/tracer.h"

namespace photorque {

// The error of a power that counts rays, where the replicates do not show it: Sobol points can meet
// a surface equally often in all of them, and still be off by part of a ray in each. One ray of
// each replicate, in the mean of all.
inline double counting_error_W(const TraceResult& result, int replicates) {
  return result.sent_W / static_cast<double>(result.rays) * std::sqrt(replicates);
}

}  // namespace photorque
