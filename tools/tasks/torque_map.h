// Force, torque and power over a grid of attitudes, or of directions of light.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/wrench.h"
#include "tools/coupling/couple.h"
#include "tools/runs/optical_run.h"

namespace photorque {

struct TorqueMapRun {
  std::shared_ptr<const OpticalRun> run;
  WrenchTable wrenches;  // of the whole scene, body frame
  RunResult result;
};

// A node of the wrench table, in their order, as it was traced.
struct TracedNode {
  const OpticalRun& run;
  size_t nodes;  // of the table
  RigidTransform lab_from_body;
  const OpticalResult& light;
  std::optional<Estimate> electric_W = {};  // of the array, where there is one
};
using NodeWatch = std::function<void(const TracedNode&)>;

// The attitudes of [torque_map], or its directions of light; the latter go on from a checkpoint.
TorqueMapRun torque_map_of_experiment(const RunOptions& options, const Console& console,
                                      const NodeWatch& watch = {},
                                      CheckpointFile* checkpoint = nullptr);

}  // namespace photorque
