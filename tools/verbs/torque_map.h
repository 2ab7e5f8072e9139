// Force, torque and power over a grid of attitudes, or wrench over directions of light.
#pragma once

#include <memory>

#include "core/wrench.h"
#include "tools/coupling/couple.h"
#include "tools/runs/optical_run.h"

namespace photorque {

struct TorqueMapRun {
  std::shared_ptr<const OpticalRun> run;
  WrenchTable wrenches;  // of the whole scene, body frame
  RunResult result;
};

// Computes the attitudes of [torque_map] or its directions of light; the latter can resume from a
// checkpoint.
TorqueMapRun run_torque_map(const RunOptions& options, const Console& console,
                            const NodeWatch& watch = {}, CheckpointFile* checkpoint = nullptr);

}  // namespace photorque
