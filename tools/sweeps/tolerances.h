// Built copies of designs: random deviations within the tolerances, equal for every design.
#pragma once

#include <vector>

#include "core/product.h"
#include "tools/sweeps/identity.h"
#include "tools/sweeps/plan.h"

namespace photorque {

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

}  // namespace photorque
