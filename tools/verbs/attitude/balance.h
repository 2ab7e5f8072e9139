// The centre of mass from a recording, and the masses' moves.
#pragma once

#include <filesystem>
#include <vector>

#include "attitude/studies/balance.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

struct BalanceOutcome {
  BalanceRun run;
  BalanceResult balance;
  RunResult result;
};

// InputError unless there is one recording.
BalanceOutcome run_balance(const RunOptions& options,
                           const std::vector<std::filesystem::path>& recordings);

}  // namespace photorque
