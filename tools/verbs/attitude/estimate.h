// Attitude and rate from recordings, or from simulated runs, by filter and smoother.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "attitude/filtering/study.h"
#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

struct EstimateRun {
  EstimateStudy study;
  // One for each recording, or one of a simulated run.
  struct Estimated {
    std::string name;
    Readings readings;
    EstimateResult result;
    std::vector<std::string> notes;  // a line each
  };
  std::vector<Estimated> estimated;
  std::optional<ConsistencyResult> consistency;  // of simulated runs
  RunResult result;
};

// Of every recording; without any, of a run simulated as [propagate] says, and of [estimate] runs
// more whose uncertain parameters are drawn. `truth` belongs to a single recording.
EstimateRun run_estimate(const RunOptions& options, const Console& console,
                         const std::vector<std::filesystem::path>& recordings,
                         const std::optional<std::filesystem::path>& truth);

}  // namespace photorque
