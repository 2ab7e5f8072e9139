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

// The table, pictures, and the best as headline figures.
Product sweep_product(const SweepPlan& plan, const SweepResult& result);

// The best design against the nominal one, printed.
void print_best(const Console& console, const SweepPlan& plan, const SweepResult& result,
                const Changes& changes);

// Problems of a sweep: failed designs, none that keeps to the constraints.
std::vector<std::string> sweep_warnings(const SweepPlan& plan, const SweepResult& result);

}  // namespace photorque
