// Designs as they would be built: drawn within their tolerances, the same draws for every design.
#pragma once

#include <vector>

#include "core/product.h"
#include "tools/sweeps/identity.h"
#include "tools/sweeps/plan.h"

namespace photorque {

class Tolerances {
 public:
  // InputError for a key without a number, or numbers, to start from.
  Tolerances(const BuiltCopies& plan, const RunIdentity& identity);

  // The changes that make copy `copy` (from 0) of a design. Every number of an array has a separate
  // random error.
  Changes built(const Changes& design, size_t copy) const;

 private:
  struct Drawn {
    Tolerance tolerance;
    std::vector<std::vector<double>> off;  // of each component, of each copy: in widths
  };
  std::vector<Drawn> drawn_;
  const RunIdentity& identity_;
};

// The value that a fraction of the copies reaches: `fraction` of the values are at least so good.
// The standard error is half the distance of the values √(n f (1 − f)) places up and down the
// order, that of independent draws (Sobol points do better). Nothing where so many copies failed
// (NaN, which is worse than any value).
std::optional<Estimate> reached_by(double fraction, bool maximise, std::vector<double> values);

}  // namespace photorque
