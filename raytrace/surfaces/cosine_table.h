// Tables of functions of the cosine of the angle from the normal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace photorque {

// `Count` functions of a cosine in [0, 1], interpolated by Catmull-Rom cubics in the root of the
// cosine. Nodes are equally spaced in the root, so that most of them are at grazing angles. The
// functions must be smooth in the cosine. The sine is not smooth at normal incidence, therefore
// components along it are tabulated after division by the sine.
template <size_t Count>
class CosineTable {
 public:
  using Values = std::array<double, Count>;

  // Tabulates `function` at the nodes.
  explicit CosineTable(const std::function<Values(double cosine)>& function) {
    for (size_t i = 0; i <= intervals; ++i) nodes_.push_back(function(node_cosine(i)));
  }

  // Interpolated values at a cosine in [0, 1].
  Values operator()(double cosine) const {
    const double place = std::sqrt(std::max(cosine, 0.0)) * static_cast<double>(intervals);
    const size_t i = std::min(static_cast<size_t>(place), intervals - 1);
    const double t = place - static_cast<double>(i);
    const Values &a = nodes_[i], &b = nodes_[i + 1];
    const Values &before = nodes_[i > 0 ? i - 1 : 0], &after = nodes_[std::min(i + 2, intervals)];
    Values values;
    for (size_t k = 0; k < Count; ++k) {
      // The first and the last interval use a parabola.
      double rise_a = 0.5 * (b[k] - before[k]), rise_b = 0.5 * (after[k] - a[k]);
      if (i == 0) rise_a = 2.0 * (b[k] - a[k]) - rise_b;
      if (i + 1 == intervals) rise_b = 2.0 * (b[k] - a[k]) - rise_a;
      const double bend = rise_a + rise_b - 2.0 * (b[k] - a[k]);
      values[k] = a[k] + t * (rise_a + t * (b[k] - a[k] - rise_a - bend + t * bend));
    }
    return values;
  }

  static constexpr size_t intervals = 96;
  // Node 0 is just above the horizon, where functions of grazing light have their limit. The last
  // node is just off the normal, where ratios to the sine have their limit.
  static double node_cosine(size_t i) {
    const double root = static_cast<double>(i) / static_cast<double>(intervals);
    return std::clamp(root * root, 1e-9, 1.0 - 1e-9);
  }

 private:
  std::vector<Values> nodes_;
};

// ∫ 2 μ g(μ) dμ over [0, 1]: mean of g for light that arrives uniformly from the hemisphere.
// Simpson's rule in the root of μ; g must be smooth in the root or come from a CosineTable.
inline double even_mean(const std::function<double(double cosine)>& g) {
  constexpr int steps = 4096;
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const double root = static_cast<double>(i) / steps, cosine = root * root;
    const double weight = i == 0 || i == steps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    // 2 μ dμ = 4 x³ dx, where x is the root.
    sum += weight * 4.0 * root * cosine * g(cosine);
  }
  return sum / (3.0 * steps);
}

}  // namespace photorque
