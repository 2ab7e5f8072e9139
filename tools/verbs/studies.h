// Common functions of `sweep` and `optimise`: the command of their runs, and their results.
#pragma once

#include <vector>

#include "core/product.h"
#include "scenes/experiment/experiment.h"
#include "tools/runs/console.h"
#include "tools/sweeps/evaluator.h"
#include "tools/verbs/verb.h"

namespace photorque {

// Plan of an experiment. Throws InputError without [sweep], or for a command without figures.
SweepPlan read_study_plan(const ExperimentFile& file, const std::vector<Verb>& verbs);

// The command of the plan on the experiment, without output and files; its runs are stored in the
// database.
RunEngine::Task study_task(const RunOptions& options, const SweepPlan& plan,
                           const std::vector<Verb>& verbs, const std::filesystem::path& database);

// Throws the error of a study without a successful run, as reported for design `design`.
[[noreturn]] void throw_failed_study(const CommandOptions& options, const RunOutcome& outcome,
                                     size_t design, size_t count);

// A study with completed designs.
struct Study {
  const CommandOptions& options;
  const Console& console;
  const ExperimentFile& file;
  const SweepPlan& plan;
  RunEngine& engine;
  SweepResult result;
};

// Finds the best design, computes built copies of it and of the nominal experiment if the plan has
// tolerances (and `may_run`), prints and writes all results; `more` is added to the product.
void finish_study(Study study, bool may_run, Product more = {});

}  // namespace photorque
