#include "tools/commands/studies.h"

#include <algorithm>

#include "core/errors.h"
#include "core/files.h"
#include "tools/commands/results.h"
#include "tools/runs/optical_run.h"
#include "tools/runs/result.h"
#include "tools/sweeps/report.h"

namespace photorque {
namespace {

const std::vector<std::string> sweepable = {"trace",   "power",     "torque-map", "budget",
                                            "balance", "propagate", "fit-cell"};

std::function<std::vector<Figure>(const RunOptions&)> run_of_verb(const CommandLine& line,
                                                                  const std::string& command) {
  const std::vector<Verb> verbs = all_verbs();
  const Verb verb = *std::ranges::find(verbs, command, &Verb::name);
  return [line, verb](const RunOptions& options) {
    CommandLine one = line;
    static_cast<RunOptions&>(one) = options;
    one.verb = verb.name;
    one.quiet = true;
    one.json = false;
    std::vector<Figure> figures;
    one.take_result = [&figures](const RunResult& result) {
      figures = figures_of(result.product.quantities);
    };
    verb.run(one);
    return figures;
  };
}

void build_copies(Study& study) {
  const SweepPlan& plan = study.plan;
  if (plan.built.tolerances.empty() || plan.built.of_every || !study.result.best) return;
  DesignEvaluator evaluator(plan, study.engine);
  study.result.built_best =
      evaluator.build(plan.overrides(*study.result.best), study.console.progress("built copies"));
  if (study.result.nominal && study.result.nominal->error.empty()) {
    study.result.built_nominal = evaluator.build({}, study.console.progress("built copies"));
  }
  study.console.done();
}

RunFile best_experiment(const Study& study, const Changes& changes) {
  std::string head = "# Design " + std::to_string(*study.result.best + 1) + " of `" +
                     study.line.verb + "` of " + study.line.experiment.filename().string() + ":\n";
  for (const std::string& change : changes) head += "#   " + change + "\n";
  const std::string text =
      study.engine.identity().experiment(changes, head, study.line.out_folder());
  return {"best.toml", [text](const std::filesystem::path& path) { write_file_whole(path, text); },
          "the best design as an experiment"};
}

}  // namespace

SweepPlan read_study_plan(const ExperimentFile& file) {
  const auto tables = file.others("sweep");
  if (tables.empty()) throw file.settings.error("sweep", "none", "a table [sweep]");
  SweepPlan plan = read_sweep_plan(tables.front());
  if (std::ranges::find(sweepable, plan.verb) == sweepable.end()) {
    throw InputError({}, "sweep.verb", '"' + plan.verb + '"',
                     "a command that writes a summary: power");
  }
  return plan;
}

RunEngine::Task study_task(const CommandLine& line, const SweepPlan& plan,
                           const std::filesystem::path& database) {
  return {line, plan.verb, database, run_of_verb(line, plan.verb),
          [&plan](const std::vector<Figure>& figures) { figure_columns(plan, figures); }};
}

void throw_failed_study(const CommandLine& line, const RunOutcome& outcome, size_t design,
                        size_t count) {
  if (outcome.status == 3) throw NumericalError(outcome.error);
  throw InputError({line.experiment.string()},
                   "design " + std::to_string(std::min(design, count - 1) + 1) + " of " +
                       std::to_string(count) + ": " + outcome.error,
                   "", "");
}

void finish_study(Study study, bool may_run, Product more) {
  // The last of several processes may be two.
  const Claims::Claim alone = study.engine.wait_for_others("table");
  SweepResult& result = study.result;
  result.best = best_design(study.plan, result.designs);
  if (may_run) build_copies(study);
  Provenance provenance = build_provenance();
  provenance.inputs = study.file.inputs;
  provenance.seed = study.file.trace.seed;
  provenance.warnings = sweep_warnings(study.plan, result);
  RunResult out{sweep_product(study.plan, result), provenance, {}};
  out.product.tables.front().name = study.line.verb;
  append(out.product, std::move(more));
  const Changes best = result.best ? study.plan.overrides(*result.best) : Changes{};
  print_best(study.console, study.plan, result, best);
  for (const std::string& warning : provenance.warnings) study.console.line("WARNING: " + warning);
  if (result.best) out.files.push_back(best_experiment(study, best));
  study.engine.database().write_designs(out.product.tables.front());
  write_results(study.line, study.console, out);
}

}  // namespace photorque
