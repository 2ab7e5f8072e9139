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

// Computes all disturbance torques at the state of [budget]. Throws InputError for invalid input.
BudgetRun run_budget(const RunOptions& options);

}  // namespace photorque
