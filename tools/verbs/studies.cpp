#include "tools/verbs/studies.h"

#include <algorithm>

#include "core/errors.h"
#include "core/files.h"
#include "tools/runs/optical_run.h"
#include "tools/runs/result.h"
#include "tools/sweeps/report.h"

namespace photorque {
namespace {

// The verb of this name; null if there is none, or if it has no figures.
const Verb* study_verb(const std::vector<Verb>& verbs, const std::string& name) {
  const auto verb = std::ranges::find(verbs, name, &Verb::name);
  return verb == verbs.end() || !verb->study ? nullptr : &*verb;
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
  std::vector<std::string> head{"Design " + std::to_string(*study.result.best + 1) + " of `" +
                                study.options.verb + "` of " +
                                study.options.experiment.filename().string() + ":"};
  for (const std::string& change : changes) head.push_back("  " + change);
  const std::string text =
      study.engine.identity().experiment(changes, head, study.options.out_folder());
  return {"best.toml", [text](const std::filesystem::path& path) { write_file_whole(path, text); },
          "the best design as an experiment"};
}

}  // namespace

SweepPlan read_study_plan(const ExperimentFile& file, const std::vector<Verb>& verbs) {
  const auto tables = file.others("sweep");
  if (tables.empty()) throw file.settings.error("sweep", "nothing", "a table [sweep]");
  SweepPlan plan = read_sweep_plan(tables.front());
  if (study_verb(verbs, plan.verb) == nullptr) {
    throw InputError({}, "sweep.verb", '"' + plan.verb + '"',
                     "a command that writes a summary: power");
  }
  return plan;
}

RunEngine::Task study_task(const RunOptions& options, const SweepPlan& plan,
                           const std::vector<Verb>& verbs, const std::filesystem::path& database) {
  const auto run = [study = study_verb(verbs, plan.verb)->study](const RunOptions& design) {
    const RunResult result = study(design);
    check_figures(result);
    return figures_of(result.product.quantities);
  };
  return {options, plan.verb, database, run,
          [&plan](const std::vector<Figure>& figures) { figure_columns(plan, figures); }};
}

void throw_failed_study(const CommandOptions& options, const RunOutcome& outcome, size_t design,
                        size_t count) {
  if (outcome.status == 3) throw NumericalError(outcome.error);
  throw InputError({options.experiment.string()},
                   "design " + std::to_string(std::min(design, count - 1) + 1) + " of " +
                       std::to_string(count) + ": " + outcome.error,
                   "", "");
}

void finish_study(Study study, bool may_run, Product more) {
  // Two processes may both be the last; only one at a time writes the results.
  const Claims::Claim alone = study.engine.wait_for_others("table");
  SweepResult& result = study.result;
  result.best = best_design(study.plan, result.designs);
  if (may_run) build_copies(study);
  Provenance provenance = build_provenance();
  provenance.inputs = study.file.inputs;
  provenance.seed = study.file.trace.seed;
  provenance.warnings = sweep_warnings(study.plan, result);
  RunResult out{sweep_product(study.plan, result), provenance, {}};
  out.product.tables.front().name = study.options.verb;
  append(out.product, std::move(more));
  const Changes best = result.best ? study.plan.overrides(*result.best) : Changes{};
  print_best(study.console, study.plan, result, best);
  const auto spread = std::ranges::find(out.product.tables, "spread", &Table::name);
  if (spread != out.product.tables.end()) print_spread(study.console, study.plan, *spread);
  for (const std::string& warning : provenance.warnings) study.console.line("WARNING: " + warning);
  if (result.best) out.files.push_back(best_experiment(study, best));
  study.engine.database().write_designs(out.product.tables.front());
  write_results(study.options, study.console, out);
}

}  // namespace photorque
