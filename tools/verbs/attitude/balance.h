// Centre of mass from a recording, and mass displacements that correct it.
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

// Throws InputError unless there is exactly one recording.
BalanceOutcome run_balance(const RunOptions& options,
                           const std::vector<std::filesystem::path>& recordings);

}  // namespace photorque
