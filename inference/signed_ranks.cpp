#include "inference/signed_ranks.h"

#include <algorithm>
#include <cmath>

namespace photorque::inference {

double signed_rank_sigma(const std::vector<double>& differences) {
  std::vector<double> x;
  for (const double d : differences) {
    if (d != 0.0 && !std::isnan(d)) x.push_back(d);
  }
  if (x.empty()) return 0.0;
  std::sort(x.begin(), x.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  double above = 0.0;
  for (size_t first = 0, last = 0; first < x.size(); first = last) {
    last = first;
    while (last < x.size() && std::abs(x[last]) == std::abs(x[first])) ++last;
    const double rank = 0.5 * static_cast<double>(first + 1 + last);
    for (size_t i = first; i < last; ++i) above += x[i] > 0.0 ? rank : 0.0;
  }
  const auto n = static_cast<double>(x.size());
  return (above - n * (n + 1.0) / 4.0) / std::sqrt(n * (n + 1.0) * (2.0 * n + 1.0) / 24.0);
}

}  // namespace photorque::inference
