// The platform through its disturbances, in the light of its scene where there is one.
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

// Torques that act besides those of the experiment, and their text in the provenance.
struct FurtherTorques {
  std::vector<Disturbance> disturbances;
  std::vector<std::pair<std::string, std::string>> inputs;  // name, hash
};

// `prepare` may change the run that was read from the experiment before it starts. With a
// checkpoint file, the run continues from the state of an equal run: the same program, experiment,
// overrides, seed and files. InputError for the checkpoint of another run.
MotionRun run_propagate(
    const RunOptions& options, const Console& console, const FurtherTorques& further = {},
    const std::function<void(const Settings& root, PropagationRun& run)>& prepare = {},
    CheckpointFile* checkpoint = nullptr);

}  // namespace photorque
