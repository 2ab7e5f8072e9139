// Maximisation of a figure over continuous keys. The only place for NLopt.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace photorque {

// Result at a point of a search: the merit (larger is better) and the margin of each constraint
// (negative if violated).
struct PointValue {
  bool failed = false;
  double merit = 0.0;
  std::vector<double> margins = {};
};

struct SearchBox {
  std::vector<double> low, high;
  std::vector<double> start;  // within the box
};

// Searches in two stages, without derivatives.
// 1. Over the whole box: dividing rectangles (D. R. Jones, C. D. Perttunen, B. E. Stuckman, J.
// Optim. Theory Appl. 79, 157 (1993); locally biased, J. M. Gablonsky and C. T. Kelley, J. Global
// Optim. 21, 27 (2001)).
// 2. From the better of its best point and `start`: quadratic models (M. J. D. Powell, BOBYQA,
// DAMTP 2009/NA06), with constraints linear models (Powell, COBYLA, 1994), until steps are below
// `precision` of the box or the evaluations are used up.
// The search is deterministic: equal values lead to equal points, so that an interrupted search
// repeats its evaluations.
//
// `value` is called with points of the box, in its units.
void search_box(const SearchBox& box, size_t global, size_t local, double precision,
                const std::function<PointValue(std::span<const double>)>& value);

}  // namespace photorque
