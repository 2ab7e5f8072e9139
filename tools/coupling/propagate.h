// Motion of the platform under its disturbances and in the light of its scene, if it has one.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "attitude/model/disturbance.h"
#include "tools/coupling/couple.h"
#include "tools/runs/result.h"

namespace photorque {

struct MotionRun {
  std::shared_ptr<const PropagationRun> run;
  std::shared_ptr<const CoupledResult> coupled;
  RunResult result;  // its files: recording.csv, attitude.aem
};

// Torques in addition to those of the experiment, and their provenance.
struct FurtherTorques {
  std::vector<Disturbance> disturbances;
  std::vector<std::pair<std::string, std::string>> inputs;  // name, hash
};

// `prepare` may change the run before it starts. With a checkpoint file, the run continues from the
// state of an equal run: the same program, experiment, overrides, seed and files. Throws InputError
// for the checkpoint of another run.
MotionRun run_propagate(
    const RunOptions& options, const Console& console, const FurtherTorques& further = {},
    const std::function<void(const Settings& root, PropagationRun& run)>& prepare = {},
    CheckpointFile* checkpoint = nullptr);

}  // namespace photorque
