// Every disturbance torque at one state.
#pragma once

#include "attitude/studies/budget.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

struct BudgetRun {
  Budget budget;
  RunResult result;
};

BudgetRun run_budget(const RunOptions& options);

}  // namespace photorque
