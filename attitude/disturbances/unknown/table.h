// A smooth table: a piecewise cubic through values at knots.
#pragma once

#include <array>
#include <vector>

namespace photorque {

// Cubic Hermite interpolation with the slopes of the parabolas through three neighbouring knots
// (Catmull and Rom for knots of any distance): once continuously differentiable, linear in the
// values, exact for parabolas, and each value acts within two intervals of its knot. Its error is
// of the third order of the knots' distance.
class SmoothTable {
 public:
  SmoothTable() = default;
  // At least four rising knots; NumericalError otherwise.
  explicit SmoothTable(std::vector<double> knots);

  // What each of four neighbouring values counts at x, and the slopes of that; x must not lie
  // outside of the knots by much (the last cubic goes on).
  struct Weights {
    int first = 0;  // knot of the first
    std::array<double, 4> value = {}, slope = {};
  };
  Weights at(double x) const;

  const std::vector<double>& knots() const { return knots_; }

 private:
  // The slope at a knot is the sum of three neighbouring values with these weights.
  struct Slope {
    size_t first = 0;
    std::array<double, 3> weight = {};
  };
  Slope slope_at(size_t knot) const;

  std::vector<double> knots_;
  std::vector<Slope> slopes_;
};

}  // namespace photorque
