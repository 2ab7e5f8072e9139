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
  std::vector<Figure> figures;  // means and worst values over the runs; none where one failed
  std::string error = {};       // of the first run that failed, with its changes
  bool feasible = true;         // succeeded, and every run's mean keeps to the constraints
};

// A figure of the copies of a design, as built.
struct BuiltFigure {
  std::string column;
  std::vector<double> values;  // of each copy; NaN where it failed
};

// The result of a sweep or a search.
struct SweepResult {
  std::vector<Design> designs;
  std::optional<Design> nominal = {};  // the nominal experiment, where there is an objective
  std::optional<size_t> best = {};
  // Their copies as built, where those of the best are asked for.
  std::vector<BuiltFigure> built_best = {}, built_nominal = {};
};

// The combined result of the runs of one design (SweepPlan::runs_of).
//
// Means: Σ w v, with the standard error Σ w σ, a bound whatever the runs have in common (they share
// a seed). Over worst_over an objective or a constrained figure takes its worst value (of a figure
// that must be between two limits, the one nearer to breaking its own); any other figure that where
// the first objective, or else the first constrained figure, is worst.
Design combine(const SweepPlan& plan, std::span<const RunOutcome> runs);

// The figure of a design, if it has it.
std::optional<Estimate> figure_of(const Design& design, const std::string& column);

// The figure by which a design is judged, larger being better; nothing where it has none.
std::optional<double> merit_of(const SweepPlan& plan, const Objective& objective,
                               const Design& design);

// The feasible design that is best in the first objective; nothing without any.
std::optional<size_t> best_design(const SweepPlan& plan, std::span<const Design> designs);

// The feasible designs than which no other is as good in every objective and better in one.
std::vector<size_t> pareto_designs(const SweepPlan& plan, std::span<const Design> designs);

}  // namespace photorque
