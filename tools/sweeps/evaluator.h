// Computes the figures of a design from its runs and from those of its built copies.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "tools/sweeps/designs.h"
#include "tools/sweeps/engine.h"
#include "tools/sweeps/plan.h"
#include "tools/sweeps/tolerances.h"

namespace photorque {

class DesignEvaluator {
 public:
  // `plan` and `engine` must outlive this object.
  DesignEvaluator(const SweepPlan& plan, RunEngine& engine);

  // All runs that these designs need; with those of built copies if the plan requires copies of
  // every design.
  std::vector<Changes> runs_of(std::span<const Changes> designs) const;
  // The designs from the outcomes of runs_of(), in the same order.
  std::vector<Design> designs_of(std::span<const RunOutcome> outcomes) const;

  // Combines runs_of() and designs_of(); computes missing runs.
  std::vector<Design> evaluate(std::span<const Changes> designs,
                               const std::function<void(double)>& progress = {});
  // Figures of the built copies of one design, one per objective.
  std::vector<BuiltFigure> build(const Changes& design,
                                 const std::function<void(double)>& progress = {});

 private:
  std::vector<Changes> copies_of(const Changes& design) const;
  size_t runs_each() const;
  Design with_built(Design design, std::span<const Design> copies) const;

  const SweepPlan& plan_;
  RunEngine& engine_;
  std::unique_ptr<Tolerances> tolerances_;  // null if the plan has no tolerances
};

}  // namespace photorque
