// The table, the figures and the plots of a sweep.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/product.h"
#include "tools/runs/console.h"
#include "tools/sweeps/designs.h"
#include "tools/sweeps/plan.h"

namespace photorque {

// The columns of figures: those named, else all, then those of objectives and constraints.
// InputError for one that a design's figures do not have, with the nearest that they do.
std::vector<std::string> figure_columns(const SweepPlan& plan, const std::vector<Figure>& figures);

// "sweep": a row per design: its number, the axes, every figure with its standard error, then,
// where asked for, `feasible` and `pareto` (1 or 0), and `error` where a design failed.
Table sweep_table(const SweepPlan& plan, const SweepResult& result);

// Spread of the figures of a random plan without an objective.
// "spread": a row per figure of `columns` with its mean, its standard deviation over the designs
// that did not fail, and for every axis of numbers "from KEY", the fraction of the variance that it
// causes: b² var(x)/var(y), b of the linear regression on all of them. The fractions sum to one
// where the figure is linear in independent inputs. Nothing for a grid, a plan with an objective,
// or fewer designs than the regression needs.
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

// The table, pictures, and the best as headline figures.
Product sweep_product(const SweepPlan& plan, const SweepResult& result);

// The best design against the nominal one, printed.
void print_best(const Console& console, const SweepPlan& plan, const SweepResult& result,
                const Changes& changes);

// Problems of a sweep: failed designs, none that keeps to the constraints.
std::vector<std::string> sweep_warnings(const SweepPlan& plan, const SweepResult& result);

}  // namespace photorque
