// Shared by `sweep` and `optimise`: the command of their runs, and their results.
#pragma once

#include <vector>

#include "core/product.h"
#include "scenes/experiment/experiment.h"
#include "tools/runs/console.h"
#include "tools/sweeps/evaluator.h"
#include "tools/verbs/verb.h"

namespace photorque {

// The plan of an experiment. InputError without [sweep], or for a command that gives no figures.
SweepPlan read_study_plan(const ExperimentFile& file, const std::vector<Verb>& verbs);

// The command of the plan on the experiment, silent and without files, its runs kept in the
// database.
RunEngine::Task study_task(const RunOptions& options, const SweepPlan& plan,
                           const std::vector<Verb>& verbs, const std::filesystem::path& database);

// The error of a study in which nothing succeeded, as reported for design `design`.
[[noreturn]] void throw_failed_study(const CommandOptions& options, const RunOutcome& outcome,
                                     size_t design, size_t count);

// A study whose designs are known.
struct Study {
  const CommandOptions& options;
  const Console& console;
  const ExperimentFile& file;
  const SweepPlan& plan;
  RunEngine& engine;
  SweepResult result;
};

// Finds the best design, computes copies of it and of the nominal experiment with tolerances, if
// the plan has them (`may_run`), prints and writes everything; `more` is added to the product.
void finish_study(Study study, bool may_run, Product more = {});

}  // namespace photorque
