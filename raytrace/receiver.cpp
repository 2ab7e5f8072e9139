#include "raytrace/receiver.h"

#include <cmath>

namespace photorque {

Estimate BinSums::estimate(size_t bin) const {
  std::vector<double> values(static_cast<size_t>(replicates));
  for (int r = 0; r < replicates; ++r) values[static_cast<size_t>(r)] = of(r)[bin];
  return with_common_error(estimate_from_replicates(values), common_error);
}

Estimate BinSums::estimate(const std::function<double(std::span<const double>)>& linear) const {
  std::vector<double> values(static_cast<size_t>(replicates));
  for (int r = 0; r < replicates; ++r) values[static_cast<size_t>(r)] = linear(of(r));
  return with_common_error(estimate_from_replicates(values), common_error);
}

Estimate with_common_error(const Estimate& estimate, double common_error) {
  return {estimate.value, std::hypot(estimate.standard_error, common_error * estimate.value)};
}

}  // namespace photorque
