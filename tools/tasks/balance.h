// The centre of mass from a recording, and the masses' moves that remove it.
#pragma once

#include "attitude/studies/balance.h"
#include "tools/runs/attitude_run.h"
#include "tools/runs/result.h"

namespace photorque {

struct BalanceOutcome {
  BalanceRun run;
  BalanceResult balance;
  RunResult result;
};

BalanceOutcome balance_of_experiment(const RunOptions& options,
                                     const std::filesystem::path& recording);

}  // namespace photorque
