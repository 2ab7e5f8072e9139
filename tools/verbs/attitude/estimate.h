// Attitude and rate from recordings or simulated runs, by filter and smoother.
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
  // One per recording, or one for a simulated run.
  struct Estimated {
    std::string name;
    Readings readings;
    EstimateResult result;
    std::vector<std::string> notes;  // one per line
  };
  std::vector<Estimated> estimated;
  std::optional<ConsistencyResult> consistency;  // of simulated runs
  RunResult result;
};

// Estimates the motion of every recording. Without recordings, it uses a run simulated by
// [propagate], and `runs` of [estimate] further runs with random values of the uncertain
// parameters. `truth` belongs to a single recording.
EstimateRun run_estimate(const RunOptions& options, const Console& console,
                         const std::vector<std::filesystem::path>& recordings,
                         const std::optional<std::filesystem::path>& truth);

}  // namespace photorque
