// Computes the figures of a design from its runs and from those of its built copies.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "tools/sweeps/designs.h"
#include "tools/sweeps/engine.h"
#include "tools/sweeps/plan.h"

namespace photorque {

// Built copies of designs: random deviations within the tolerances, equal for every design.
class Tolerances {
 public:
  // Throws InputError for a key without numbers.
  Tolerances(const BuiltCopies& plan, const RunIdentity& identity);

  // Changes that define copy `copy` (from 0) of a design. Every number of an array has a separate
  // random error.
  Changes built(const Changes& design, size_t copy) const;

 private:
  struct Drawn {
    Tolerance tolerance;
    std::vector<std::vector<double>> off;  // [component][copy]: deviation in units of the width
  };
  std::vector<Drawn> drawn_;
  const RunIdentity& identity_;
};

// The value that a fraction of the copies reaches: `fraction` of the values are at least as good.
// The standard error is half the difference between the values √(n f (1 − f)) places higher and
// lower in the order, which is valid for independent draws (Sobol points have a smaller error).
// Empty if too many copies failed (NaN, which counts as worst).
std::optional<Estimate> reached_by(double fraction, bool maximise, std::vector<double> values);

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
