// Pictures of a sweep.
#pragma once

#include <string>
#include <vector>

#include "core/product.h"
#include "tools/sweeps/designs.h"
#include "tools/sweeps/plan.h"

namespace photorque {

// Of these figures: over one axis a curve; over two a map, and over more a map for every pair, each
// point the best that the others allow; of a random plan a scatter over every axis; where axes are
// no numbers, curves over the last. With several objectives the first against each other, with the
// Pareto front. The distribution of built copies.
void add_pictures(Product& product, const SweepPlan& plan, const SweepResult& result,
                  const std::vector<std::string>& figures);

// How a search went: every evaluation and the best so far.
Plot search_plot(const SweepPlan& plan, const SweepResult& result);

}  // namespace photorque
