#include "tools/tasks/balance.h"

namespace photorque {

BalanceOutcome balance_of_experiment(const RunOptions& options,
                                     const std::filesystem::path& recording) {
  const WallTime wall;
  AttitudeExperiment experiment(options);
  experiment.add_input(recording);
  BalanceRun run = read_balance(experiment.settings(), recording);
  BalanceResult found = balance(run);
  Product product = balance_product(run, found);
  Provenance provenance = experiment.provenance(0);
  if (found.leaves_more_than_noise()) provenance.warnings.push_back(found.warning());
  RunResult result{std::move(product), std::move(provenance), {wall.elapsed_s(), {}}};
  return {std::move(run), std::move(found), std::move(result)};
}

}  // namespace photorque
