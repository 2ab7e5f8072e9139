// The page of `torque-map`: the body at every attitude or direction of light, by sliders.
#pragma once

#include <memory>

#include "core/wrench_table.h"
#include "tools/pages/runs.h"

namespace photorque {

// Grows while the nodes are traced, since their maps are not part of the run's result.
class TorqueMapStage {
 public:
  TorqueMapStage();
  // Valid as long as this.
  NodeWatch watch();
  SceneStage take() { return std::move(*stage_); }

 private:
  std::unique_ptr<SceneStage> stage_;
};

RunFile torque_map_page(const OpticalRun& run, const WrenchTable& table, const RunResult& result,
                        TorqueMapStage stage, const PageHead& head);

}  // namespace photorque
