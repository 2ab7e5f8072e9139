// Standard errors of results that are not linear in the bins.
#pragma once

#include <functional>
#include <span>

#include "core/product.h"
#include "raytrace/receiver.h"

namespace photorque {

// The bins averaged over all replicates.
std::vector<double> mean_bins(const BinSums& sums);

// A smooth function of the mean bins, with the bias of order 1/replicates removed (all of it for
// quadratic functions, such as a variance) and its standard error, by leaving out one replicate
// after the other. Not for extremes, which are not smooth. At least two replicates.
// Source: M. H. Quenouille (Biometrika 43, 1956) for the bias; J. W. Tukey (1958) for the error.
Estimate jackknife(const BinSums& sums,
                   const std::function<double(std::span<const double>)>& statistic);

}  // namespace photorque
