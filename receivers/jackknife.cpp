#include "receivers/jackknife.h"

#include <cmath>

namespace photorque {

std::vector<double> mean_bins(const BinSums& sums) {
  std::vector<double> mean(sums.bins, 0.0);
  for (int r = 0; r < sums.replicates; ++r) {
    const std::span<const double> replicate = sums.of(r);
    for (size_t bin = 0; bin < sums.bins; ++bin) mean[bin] += replicate[bin];
  }
  for (double& bin : mean) bin /= sums.replicates;
  return mean;
}

Estimate jackknife(const BinSums& sums,
                   const std::function<double(std::span<const double>)>& statistic) {
  const std::vector<double> all = mean_bins(sums);
  const double count = sums.replicates;
  std::vector<double> without(sums.bins);
  std::vector<double> left_out;
  for (int r = 0; r < sums.replicates; ++r) {
    const std::span<const double> replicate = sums.of(r);
    for (size_t bin = 0; bin < sums.bins; ++bin) {
      without[bin] = (count * all[bin] - replicate[bin]) / (count - 1.0);
    }
    left_out.push_back(statistic(without));
  }
  // The pseudo-values count·θ − (count − 1)·θ₍ᵣ₎ have this standard error (Tukey).
  const Estimate spread = estimate_from_replicates(left_out);
  return with_common_error({count * statistic(all) - (count - 1.0) * spread.value,
                            (count - 1.0) * spread.standard_error},
                           sums.common_error());
}

}  // namespace photorque
