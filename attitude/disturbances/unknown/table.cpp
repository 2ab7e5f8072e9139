#include "attitude/disturbances/unknown/table.h"

#include <algorithm>

#include "core/errors.h"

namespace photorque {

SmoothTable::SmoothTable(std::vector<double> knots) : knots_(std::move(knots)) {
  bool good = knots_.size() >= 4;
  for (size_t i = 1; good && i < knots_.size(); ++i) good = knots_[i] > knots_[i - 1];
  if (!good) throw NumericalError("a smooth table needs four rising knots");
  for (size_t i = 0; i < knots_.size(); ++i) slopes_.push_back(slope_at(i));
}

// Of the parabola through three values (Lagrange), at one of their knots.
SmoothTable::Slope SmoothTable::slope_at(size_t knot) const {
  Slope slope;
  slope.first = std::clamp<size_t>(knot, 1, knots_.size() - 2) - 1;
  for (size_t j = 0; j < 3; ++j) {
    double numerator = 0.0, denominator = 1.0;
    for (size_t k = 0; k < 3; ++k) {
      if (k == j) continue;
      denominator *= knots_[slope.first + j] - knots_[slope.first + k];
      // d/dx of the product of (x − x_k) leaves the other factor.
      const size_t other = 3 - j - k;
      numerator += knots_[knot] - knots_[slope.first + other];
    }
    slope.weight[j] = numerator / denominator;
  }
  return slope;
}

SmoothTable::Weights SmoothTable::at(double x) const {
  const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, x);
  const auto i = static_cast<size_t>(above - knots_.begin()) - 1;
  const double h = knots_[i + 1] - knots_[i], t = (x - knots_[i]) / h;
  const size_t first = std::min(i == 0 ? 0 : i - 1, knots_.size() - 4);
  Weights w;
  w.first = static_cast<int>(first);
  const auto add = [&](size_t knot, double value, double slope) {
    w.value[knot - first] += value;
    w.slope[knot - first] += slope;
  };
  const double t2 = t * t, t3 = t2 * t;
  add(i, 1.0 - 3.0 * t2 + 2.0 * t3, (6.0 * t2 - 6.0 * t) / h);
  add(i + 1, 3.0 * t2 - 2.0 * t3, (6.0 * t - 6.0 * t2) / h);
  for (size_t k = 0; k < 3; ++k) {
    const Slope &left = slopes_[i], &right = slopes_[i + 1];
    add(left.first + k, left.weight[k] * h * (t - 2.0 * t2 + t3),
        left.weight[k] * (1.0 - 4.0 * t + 3.0 * t2));
    add(right.first + k, right.weight[k] * h * (t3 - t2), right.weight[k] * (3.0 * t2 - 2.0 * t));
  }
  return w;
}

}  // namespace photorque
