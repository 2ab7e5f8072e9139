// Every disturbance torque at one state.
#pragma once

#include "attitude/studies/budget.h"
#include "tools/runs/attitude_run.h"
#include "tools/runs/result.h"

namespace photorque {

struct BudgetRun {
  Budget budget;
  RunResult result;
};

BudgetRun budget_of_experiment(const RunOptions& options);

}  // namespace photorque
