#include "tools/tasks/budget.h"

namespace photorque {

BudgetRun budget_of_experiment(const RunOptions& options) {
  const WallTime wall;
  const AttitudeExperiment experiment(options);
  Budget budget = read_budget(experiment.settings());
  Product product = budget_product(budget);
  RunResult result{std::move(product), experiment.provenance(0), {wall.elapsed_s(), {}}};
  return {std::move(budget), std::move(result)};
}

}  // namespace photorque
