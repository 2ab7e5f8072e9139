// Table, figures and plots of a sweep.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/product.h"
#include "tools/runs/console.h"
#include "tools/sweeps/designs.h"
#include "tools/sweeps/plan.h"

namespace photorque {

// Columns of figures: those named in the plan (by default all), then those of objectives and
// constraints. Throws InputError for a missing figure, with the most similar existing name.
std::vector<std::string> figure_columns(const SweepPlan& plan, const std::vector<Figure>& figures);

// Table "sweep", one row per design: its number, the axes, every figure with its standard error;
// then, if applicable, `feasible` and `pareto` (1 or 0) and `error` for failed designs.
Table sweep_table(const SweepPlan& plan, const SweepResult& result);

// Table "spread" of a random plan without an objective, one row per figure of `columns`. It
// contains the mean, the standard deviation over the designs that did not fail, and for every
// numeric axis "from KEY", its fraction of the variance: b² var(x)/var(y) with b from linear
// regression on all axes. The fractions sum to one if the figure is linear in independent inputs.
// Empty for a grid, a plan with an objective, or fewer designs than the regression needs.
std::optional<Table> spread_table(const SweepPlan& plan, const SweepResult& result,
                                  const std::vector<std::string>& columns);

void print_spread(const Console& console, const SweepPlan& plan, const Table& spread);

// Plots of these figures: a curve over one axis, a map over two, and a map for every pair of more
// axes, in which each point is the best design over the other axes. A random plan gives a scatter
// plot over every axis. If axes are not numbers, curves are over the last one. With several
// objectives, the first is plotted against each other one, with the Pareto front. Also the
// distribution of built copies.
void add_pictures(Product& product, const SweepPlan& plan, const SweepResult& result,
                  const std::vector<std::string>& figures);

// Progress of a search: every evaluation and the best so far.
Plot search_plot(const SweepPlan& plan, const SweepResult& result);

// Table, pictures, and the best design as main figures.
Product sweep_product(const SweepPlan& plan, const SweepResult& result);

// Prints the best design compared with the nominal one.
void print_best(const Console& console, const SweepPlan& plan, const SweepResult& result,
                const Changes& changes);

// Problems of a sweep: failed designs, or no design that satisfies the constraints.
std::vector<std::string> sweep_warnings(const SweepPlan& plan, const SweepResult& result);

}  // namespace photorque
