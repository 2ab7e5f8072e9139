#include "tools/sweeps/optimiser.h"

#include <nlopt.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace photorque {
namespace {

using Point = std::vector<double>;

bool is_feasible(const PointValue& value) {
  return !value.failed && std::isfinite(value.merit) &&
         std::ranges::all_of(value.margins, [](double m) { return m >= 0.0; });
}

// The search problem with the box scaled to the unit cube. It stores the last evaluation, because
// NLopt evaluates constraints at the same point as the objective.
class Problem {
 public:
  Problem(const SearchBox& box, size_t most_evaluations,
          const std::function<PointValue(std::span<const double>)>& value)
      : box_(box), value_(value), left_(most_evaluations) {
    best_ = unit(box.start);
    at(best_);
  }

  size_t dimensions() const { return box_.low.size(); }
  const Point& best() const { return best_; }

  // Number of constraints, known after the first point that did not fail; 0 before.
  size_t constraints() const { return constraints_; }

  // Throws nlopt::forced_stop if no evaluation is left. The evaluations are counted here, because
  // NLopt counts failed points differently.
  const PointValue& at(const Point& x) {
    if (x == last_) return last_value_;
    if (left_ == 0) throw nlopt::forced_stop();
    --left_;
    last_ = x;
    last_value_ = value_(inside(x));
    constraints_ = std::max(constraints_, last_value_.margins.size());
    const bool feasible = is_feasible(last_value_);
    if (feasible && (!best_merit_ || last_value_.merit > *best_merit_)) {
      best_merit_ = last_value_.merit;
      best_ = x;
    }
    if (!last_value_.failed && std::isfinite(last_value_.merit)) {
      least_ = std::min(least_, last_value_.merit);
      most_ = std::max(most_, last_value_.merit);
    }
    return last_value_;
  }

  // The merit for a local model: a failed point is worse than all others.
  double merit_or_penalty(const Point& x) {
    const PointValue& value = at(x);
    if (!value.failed && std::isfinite(value.merit)) return value.merit;
    return least_ > most_ ? 0.0 : least_ - (most_ - least_);
  }

 private:
  Point unit(const Point& x) const {
    Point u(x.size());
    for (size_t i = 0; i < x.size(); ++i) {
      u[i] = std::clamp((x[i] - box_.low[i]) / (box_.high[i] - box_.low[i]), 0.0, 1.0);
    }
    return u;
  }
  Point inside(const Point& u) const {
    Point x(u.size());
    for (size_t i = 0; i < u.size(); ++i) {
      x[i] =
          std::clamp(box_.low[i] + u[i] * (box_.high[i] - box_.low[i]), box_.low[i], box_.high[i]);
    }
    return x;
  }

  const SearchBox& box_;
  const std::function<PointValue(std::span<const double>)>& value_;
  size_t left_, constraints_ = 0;
  Point last_, best_;
  PointValue last_value_;
  std::optional<double> best_merit_;
  double least_ = std::numeric_limits<double>::infinity(), most_ = -least_;
};

void run(nlopt::opt& optimiser, Problem& problem, size_t evaluations) {
  optimiser.set_lower_bounds(Point(problem.dimensions(), 0.0));
  optimiser.set_upper_bounds(Point(problem.dimensions(), 1.0));
  optimiser.set_maxeval(static_cast<int>(evaluations));
  Point x = problem.best();
  double value = 0.0;
  try {
    optimiser.optimize(x, value);
  } catch (const nlopt::roundoff_limited&) {
    // The limit of rounding is reached; the best point is stored.
  } catch (const nlopt::forced_stop&) {
    // All evaluations are used up.
  }
}

double global_merit(const Point& x, Point&, void* problem) {
  const PointValue& value = static_cast<Problem*>(problem)->at(x);
  return is_feasible(value) ? -value.merit : std::numeric_limits<double>::infinity();
}

double local_merit(const Point& x, Point&, void* problem) {
  return -static_cast<Problem*>(problem)->merit_or_penalty(x);
}

struct LocalConstraint {
  Problem* problem;
  size_t index;
};

// The constraint as NLopt requires it: at most zero for feasible points.
double constraint_value(const Point& x, Point&, void* data) {
  const auto& constraint = *static_cast<LocalConstraint*>(data);
  const PointValue& value = constraint.problem->at(x);
  return value.failed || constraint.index >= value.margins.size()
             ? 1.0
             : -value.margins[constraint.index];
}

}  // namespace

void search_box(const SearchBox& box, size_t global, size_t local, double precision,
                const std::function<PointValue(std::span<const double>)>& value) {
  Problem problem(box, std::max<size_t>(1, global + local), value);
  const auto dimensions = static_cast<unsigned>(problem.dimensions());
  if (global > 0) {
    nlopt::opt wide(nlopt::GN_ORIG_DIRECT_L, dimensions);
    wide.set_min_objective(global_merit, &problem);
    run(wide, problem, global);
  }
  if (local == 0) return;
  const size_t constraints = problem.constraints();
  // BOBYQA needs at least two dimensions and has no constraints.
  nlopt::opt near(constraints > 0 || dimensions < 2 ? nlopt::LN_COBYLA : nlopt::LN_BOBYQA,
                  dimensions);
  near.set_min_objective(local_merit, &problem);
  std::vector<LocalConstraint> each;
  for (size_t i = 0; i < constraints; ++i) each.push_back({&problem, i});
  for (LocalConstraint& one : each) near.add_inequality_constraint(constraint_value, &one, 0.0);
  near.set_xtol_abs(precision);
  constexpr double first_step = 0.1;  // of the box
  near.set_initial_step(first_step);
  run(near, problem, local);
}

}  // namespace photorque
