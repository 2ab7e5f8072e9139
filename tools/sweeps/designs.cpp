#include "tools/sweeps/designs.h"

#include <algorithm>
#include <cmath>

#include "core/text/format.h"

namespace photorque {
namespace {

// Adds the absolute values of figures that the plan uses, such as |torque|.
std::vector<Figure> with_absolutes(const SweepPlan& plan, std::vector<Figure> figures) {
  const auto add = [&figures](const SweepFigure& wanted) {
    const Figure* plain = find_figure(figures, wanted.name);
    if (!wanted.absolute || plain == nullptr || find_figure(figures, wanted.column()) != nullptr) {
      return;
    }
    const Estimate size{std::abs(plain->estimate.value), plain->estimate.standard_error};
    figures.push_back({FigureName(wanted.column()), size});
  };
  for (const Objective& objective : plan.objectives) add(objective.figure);
  for (const Constraint& constraint : plan.constraints) add(constraint.figure);
  return figures;
}

std::vector<Figure> mean_of(const SweepPlan& plan, std::span<const RunOutcome> runs,
                            const std::vector<double>& weights) {
  std::vector<Figure> mean = with_absolutes(plan, runs.front().figures);
  for (Figure& q : mean) q.estimate = {0.0, 0.0};
  for (size_t i = 0; i < runs.size(); ++i) {
    const std::vector<Figure> figures = with_absolutes(plan, runs[i].figures);
    for (Figure& q : mean) {
      const Figure* one = find_figure(figures, q.name.text());
      const double nan = std::numeric_limits<double>::quiet_NaN();
      const Estimate value = one == nullptr ? Estimate{nan, nan} : one->estimate;
      q.estimate.value += weights[i] * value.value;
      q.estimate.standard_error += weights[i] * value.standard_error;
    }
  }
  return mean;
}

// Distance of a figure to its nearest limit; negative outside the limits.
double margin(const Constraint& constraint, double value) {
  return std::min(value - constraint.at_least, constraint.at_most - value);
}

bool satisfies_constraints(const SweepPlan& plan, const std::vector<Figure>& figures) {
  return std::ranges::all_of(plan.constraints, [&](const Constraint& constraint) {
    const Figure* q = find_figure(figures, constraint.figure.column());
    return q != nullptr && margin(constraint, q->estimate.value) >= 0.0;
  });
}

// Index of the point with the smallest `goodness` of the figure.
template <typename Goodness>
size_t worst_point(const std::vector<std::vector<Figure>>& points, const std::string& name,
                   const Goodness& goodness) {
  size_t worst = 0;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < points.size(); ++i) {
    const Figure* q = find_figure(points[i], name);
    const double good = q == nullptr ? least : goodness(q->estimate.value);
    if (good < least) {
      least = good;
      worst = i;
    }
  }
  return worst;
}

std::vector<Figure> worst_of(const SweepPlan& plan,
                             const std::vector<std::vector<Figure>>& points) {
  if (points.size() == 1) return points.front();
  struct Lead {
    std::string name;
    size_t point;
  };
  std::vector<Lead> leads;
  for (const Objective& objective : plan.objectives) {
    const double sign = objective.maximise ? 1.0 : -1.0;
    const std::string name = objective.figure.column();
    leads.push_back({name, worst_point(points, name, [&](double v) { return sign * v; })});
  }
  for (const Constraint& constraint : plan.constraints) {
    const std::string name = constraint.figure.column();
    if (std::ranges::find(leads, name, &Lead::name) != leads.end()) continue;
    leads.push_back(
        {name, worst_point(points, name, [&](double v) { return margin(constraint, v); })});
  }
  std::vector<Figure> worst = points[leads.front().point];
  for (const Lead& lead : leads) {
    const Figure* q = find_figure(points[lead.point], lead.name);
    if (q == nullptr) continue;
    std::ranges::find(worst, q->name, &Figure::name)->estimate = q->estimate;
  }
  return worst;
}

std::string failed_run_label(const SweepPlan& plan, size_t run) {
  const std::string where = joined_text(plan.runs_of({})[run], ", ");
  return where.empty() ? "" : " (" + where + ")";
}

// Values of the objectives, converted so that larger is better; empty if the design does not count.
std::vector<double> merits(const SweepPlan& plan, const Design& design) {
  std::vector<double> all;
  if (!design.feasible) return all;
  for (const Objective& objective : plan.objectives) {
    const auto merit = merit_of(plan, objective, design);
    if (!merit || std::isnan(*merit)) return {};
    all.push_back(*merit);
  }
  return all;
}

bool dominates(const std::vector<double>& a, const std::vector<double>& b) {
  bool better = false;
  for (size_t i = 0; i < a.size(); ++i) {
    if (a[i] < b[i]) return false;
    better = better || a[i] > b[i];
  }
  return better;
}

}  // namespace

Design combine(const SweepPlan& plan, std::span<const RunOutcome> runs) {
  for (size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].failed()) return {{}, runs[i].error + failed_run_label(plan, i), false};
  }
  const std::vector<double> weights = plan.mean_weights();
  std::vector<std::vector<Figure>> points;
  bool feasible = true;
  for (size_t begin = 0; begin < runs.size(); begin += weights.size()) {
    points.push_back(mean_of(plan, runs.subspan(begin, weights.size()), weights));
    feasible = feasible && satisfies_constraints(plan, points.back());
  }
  return {worst_of(plan, points), "", feasible};
}

std::optional<Estimate> figure_of(const Design& design, const std::string& column) {
  const Figure* q = find_figure(design.figures, column);
  return q == nullptr ? std::nullopt : std::optional(q->estimate);
}

std::optional<double> merit_of(const SweepPlan& plan, const Objective& objective,
                               const Design& design) {
  const auto figure = figure_of(design, plan.judged_column(objective));
  if (!figure) return std::nullopt;
  return objective.maximise ? figure->value : -figure->value;
}

std::optional<size_t> best_design(const SweepPlan& plan, std::span<const Design> designs) {
  std::optional<size_t> best;
  double most = -std::numeric_limits<double>::infinity();
  for (size_t d = 0; d < designs.size(); ++d) {
    const std::vector<double> own = merits(plan, designs[d]);
    if (own.empty() || !(own.front() > most)) continue;
    most = own.front();
    best = d;
  }
  return best;
}

std::vector<size_t> pareto_designs(const SweepPlan& plan, std::span<const Design> designs) {
  std::vector<std::pair<size_t, std::vector<double>>> front;
  for (size_t d = 0; d < designs.size(); ++d) {
    std::vector<double> own = merits(plan, designs[d]);
    if (own.empty()) continue;
    if (std::ranges::any_of(front, [&](const auto& f) { return dominates(f.second, own); })) {
      continue;
    }
    std::erase_if(front, [&](const auto& f) { return dominates(own, f.second); });
    front.emplace_back(d, std::move(own));
  }
  std::vector<size_t> all;
  for (const auto& [d, unused] : front) all.push_back(d);
  return all;
}

}  // namespace photorque
