// Designs: the combined results of their runs, their constraints, and the best designs.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/sweeps/outcome.h"
#include "tools/sweeps/plan.h"

namespace photorque {

struct Design {
  std::vector<Figure> figures;  // means and worst values over the runs; empty if a run failed
  std::string error = {};       // of the first failed run, with its changes
  bool feasible = true;         // all runs succeeded and the means satisfy the constraints
};

// A figure of the built copies of a design.
struct BuiltFigure {
  std::string column;
  std::vector<double> values;  // one per copy; NaN if it failed
};

// The result of a sweep or a search.
struct SweepResult {
  std::vector<Design> designs;
  std::optional<Design> nominal = {};  // the nominal experiment, if there is an objective
  std::optional<size_t> best = {};
  // Figures of the built copies of these designs, if the plan requests them.
  std::vector<BuiltFigure> built_best = {}, built_nominal = {};
};

// Combines the results of the runs of one design (SweepPlan::runs_of).
//
// Means are Σ w v with the standard error Σ w σ, which is an upper bound for any correlation of the
// runs (they share a seed). Over the values of worst_over, an objective or a constrained figure
// takes its worst value; for two limits, the value nearest to violating one. Any other figure takes
// its value where the first objective (without one, the first constrained figure) is worst.
Design combine(const SweepPlan& plan, std::span<const RunOutcome> runs);

// The figure of a design; empty if it does not have it.
std::optional<Estimate> figure_of(const Design& design, const std::string& column);

// Value of a design in an objective, converted so that larger is better; empty if it has none.
std::optional<double> merit_of(const SweepPlan& plan, const Objective& objective,
                               const Design& design);

// Index of the feasible design that is best in the first objective; empty if there is none.
std::optional<size_t> best_design(const SweepPlan& plan, std::span<const Design> designs);

// Indices of the feasible designs for which no other design is as good in every objective and
// better in one.
std::vector<size_t> pareto_designs(const SweepPlan& plan, std::span<const Design> designs);

}  // namespace photorque
