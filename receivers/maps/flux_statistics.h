// What a flux map says in few numbers.
#pragma once

#include "receivers/maps/flux_map.h"

namespace photorque {

// Statistics of the irradiance in all bands. Averages weigh bins by area. Extremes are over bins
// with at least a tenth of the median area of surface (slivers hold too little light to judge) and
// carry the error of their own bin: where bins are noisy, they lie outside the true extremes.
struct FluxStatistics {
  Estimate mean_W_m2;
  Estimate min_W_m2;
  Estimate max_W_m2;
  Estimate uniformity;  // min / mean
  // Standard deviation over the surface / mean, with the noise of the bins removed; never negative,
  // so that a uniform field gives a value within its error of zero.
  Estimate variation;
  // Root mean square of standard error / value over bins above 10 % of the maximum.
  double relative_error = 0.0;
};

// `map` must be receiver.flux_map(sums). At least two replicates. All zero for a dark surface.
FluxStatistics flux_statistics(const FluxMapReceiver& receiver, const FluxMap& map,
                               const BinSums& sums);

}  // namespace photorque
