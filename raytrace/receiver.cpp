#include "raytrace/receiver.h"

#include <cmath>

namespace photorque {

Estimate BinSums::estimate(size_t bin) const {
  std::vector<double> values(static_cast<size_t>(replicates));
  for (int r = 0; r < replicates; ++r) values[static_cast<size_t>(r)] = of(r)[bin];
  return with_bound(estimate_from_replicates(values), bound_of(bin));
}

double BinSums::common_error() const {
  if (bound.empty()) return 0.0;
  double size = 0.0, bounds = 0.0;
  for (int r = 0; r < replicates; ++r) {
    for (const double value : of(r)) size += std::abs(value) / replicates;
  }
  for (const double one : bound) bounds += one;
  return size > 0.0 ? bounds / size : 0.0;
}

Estimate BinSums::estimate(const std::function<double(std::span<const double>)>& linear) const {
  std::vector<double> values(static_cast<size_t>(replicates));
  for (int r = 0; r < replicates; ++r) values[static_cast<size_t>(r)] = linear(of(r));
  return with_common_error(estimate_from_replicates(values), common_error());
}

Estimate with_bound(const Estimate& estimate, double bound) {
  return {estimate.value, std::hypot(estimate.standard_error, bound)};
}

Estimate with_common_error(const Estimate& estimate, double common_error) {
  return with_bound(estimate, common_error * estimate.value);
}

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
  // Standard error of the pseudo-values count·θ − (count − 1)·θ₍ᵣ₎ (Tukey).
  const Estimate spread = estimate_from_replicates(left_out);
  return with_common_error({count * statistic(all) - (count - 1.0) * spread.value,
                            (count - 1.0) * spread.standard_error},
                           sums.common_error());
}

}  // namespace photorque
