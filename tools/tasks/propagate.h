// The platform through its disturbances, in the light of its scene where there is one.
#pragma once

#include <memory>

#include "tools/coupling/couple.h"
#include "tools/runs/attitude_run.h"
#include "tools/runs/result.h"

namespace photorque {

struct MotionRun {
  std::shared_ptr<const PropagationRun> run;
  std::shared_ptr<const CoupledResult> coupled;
  RunResult result;  // its files: recording.csv, attitude.aem
};

MotionRun propagate_experiment(const RunOptions& options, const Console& console);

}  // namespace photorque
