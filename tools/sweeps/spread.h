// How far uncertain inputs spread the figures: a random plan without an objective.
#pragma once

#include <optional>

#include "core/product.h"
#include "tools/runs/console.h"
#include "tools/sweeps/designs.h"
#include "tools/sweeps/plan.h"

namespace photorque {

// "spread": a row per figure of `columns` with its mean, its standard deviation over the designs
// that did not fail, and for every axis of numbers "from KEY", the fraction of the variance that it
// causes: b² var(x)/var(y), b of the linear regression on all of them. The fractions sum to one
// where the figure is linear in independent inputs. Nothing for a grid, a plan with an objective,
// or fewer designs than the regression needs.
std::optional<Table> spread_table(const SweepPlan& plan, const SweepResult& result,
                                  const std::vector<std::string>& columns);

void print_spread(const Console& console, const SweepPlan& plan, const Table& spread);

}  // namespace photorque
