#include "tools/sweeps/keys.h"

#include "tools/sweeps/plan.h"

namespace photorque {

Key sweep_table() {
  using namespace axis_key;
  const std::vector<Key> grid = {axis_key::values, from, to, count, spacing};
  const Key axis = sweep_key::axis.of(joined({{key, name}, grid, {mean, sigma}}));
  const Key mean_over =
      sweep_key::mean_over.of({key, axis_key::values.meaning("numbers; *or*"), weights,
                               from.meaning("start of an interval for the Gauss–Legendre rule"),
                               to.meaning("end of the interval"), nodes});
  const Key worst_over = sweep_key::worst_over.of(joined({{key}, grid}));
  const Key tolerance =
      sweep_key::tolerance.of({key, sigma.meaning("normal with this standard deviation; *or*"),
                               half_width, seed, relative});
  const Key constraint = sweep_key::constraint.of(
      {constraint_key::figure, constraint_key::at_least, constraint_key::at_most});
  using namespace sweep_key;
  return sweep.of({verb, figures, maximise, minimise, designs, sweep_key::seed, axis, mean_over,
                   worst_over, constraint, tolerance, built_copies,
                   built_fraction.with_default(BuiltCopies{}.fraction), built_of, built_seed,
                   global, local, precision.with_default(SearchPlan{}.precision)});
}

}  // namespace photorque
