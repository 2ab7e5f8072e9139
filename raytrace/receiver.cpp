#include "raytrace/receiver.h"

namespace photorque {

Estimate BinSums::estimate(size_t bin) const {
  std::vector<double> values(static_cast<size_t>(replicates));
  for (int r = 0; r < replicates; ++r) values[static_cast<size_t>(r)] = of(r)[bin];
  return estimate_from_replicates(values);
}

Estimate BinSums::estimate(const std::function<double(std::span<const double>)>& linear) const {
  std::vector<double> values(static_cast<size_t>(replicates));
  for (int r = 0; r < replicates; ++r) values[static_cast<size_t>(r)] = linear(of(r));
  return estimate_from_replicates(values);
}

}  // namespace photorque
