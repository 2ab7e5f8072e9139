// photorque sweep: one command over many designs, and what they gave as one table.
#include <algorithm>
#include <cstdio>

#include "core/files.h"
#include "scenes/experiment/experiment.h"
#include "tools/commands/results.h"
#include "tools/commands/sweep_runs.h"
#include "tools/commands/terminal.h"
#include "tools/sweeps/engine.h"
#include "tools/sweeps/report.h"

namespace photorque {
namespace {

struct Shard {
  size_t number = 1, count = 1;
  bool takes(size_t design) const { return design % count == number - 1; }
};

Shard read_shard(const std::string& text) {
  if (text.empty()) return {};
  unsigned k = 0, n = 0;
  int end = 0;
  if (std::sscanf(text.c_str(), "%u/%u%n", &k, &n, &end) != 2 ||
      end != static_cast<int>(text.size()) || k < 1 || k > n) {
    throw InputError({"--shard"}, "shard", '"' + text + '"', "K/N with 1 <= K <= N");
  }
  return {k, n};
}

// All runs of some designs, one design after the other; number designs() is the nominal one.
std::vector<Changes> runs_of_designs(const SweepPlan& plan, const std::vector<size_t>& designs) {
  std::vector<Changes> all;
  for (const size_t design : designs) {
    const Changes own = design < plan.designs() ? plan.overrides(design) : Changes{};
    std::ranges::move(plan.runs_of(own), std::back_inserter(all));
  }
  return all;
}

std::vector<size_t> designs_and_nominal(const SweepPlan& plan) {
  std::vector<size_t> all(plan.designs() + (plan.objectives.empty() ? 0 : 1));
  for (size_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

// The same error, said of the plan.
InputError in_design(const CommandLine& line, size_t design, size_t count,
                     const std::string& error) {
  return {{line.experiment.string()},
          "design " + std::to_string(design + 1) + " of " + std::to_string(count) + ": " + error,
          "",
          ""};
}

SweepResult result_of(const SweepPlan& plan, const std::vector<RunOutcome>& outcomes) {
  const size_t each = plan.mean_points() * plan.worst_points();
  SweepResult result;
  for (size_t begin = 0; begin < outcomes.size(); begin += each) {
    Design design = combine(plan, std::span(outcomes).subspan(begin, each));
    if (result.designs.size() < plan.designs()) {
      result.designs.push_back(std::move(design));
    } else {
      result.nominal = std::move(design);
    }
  }
  result.best = best_design(plan, result.designs);
  return result;
}

class SweepRun {
 public:
  explicit SweepRun(const CommandLine& line)
      : line_(line),
        console_(terminal(line)),
        file_(read_experiment_file(line.experiment, line.all_overrides())),
        plan_(read_plan()),
        shard_(read_shard(line.shard)),
        files_{line.out_folder()} {}

  void run() {
    const size_t each = plan_.mean_points() * plan_.worst_points();
    console_.heading(std::to_string(plan_.designs()) + " designs by `" + plan_.verb + '`' +
                     (each > 1 ? ", " + std::to_string(each) + " runs each" : ""));
    if (!line_.collect && !line_.shard.empty()) {
      run_shard();
      if (!all_shards_are_there()) {
        console_.line("  not all shards are done; the table is written by the last");
        return;
      }
    }
    run_here();
  }

 private:
  SweepPlan read_plan() const {
    const auto tables = file_.others("sweep");
    if (tables.empty()) throw file_.settings.error("sweep", "none", "a table [sweep]");
    SweepPlan plan = read_sweep_plan(tables.front());
    require_sweepable(plan.verb);
    return plan;
  }

  RunEngine::Task task(const std::filesystem::path& database) const {
    return {line_, plan_.verb, database, run_of_verb(line_, plan_.verb),
            [this](const std::vector<Quantity>& figures) { figure_columns(plan_, figures); }};
  }

  // Every design of this shard, into the shard's own database, and a copy of it when all are done.
  void run_shard() {
    std::vector<size_t> own = designs_and_nominal(plan_);
    std::erase_if(own, [this](size_t design) { return !shard_.takes(design); });
    RunEngine engine(task(files_.shard(shard_.number, shard_.count)));
    const std::vector<RunOutcome> outcomes = run_all(engine, own);
    if (engine.has_database()) {
      engine.database().copy_to(files_.done_shard(shard_.number, shard_.count));
    }
  }

  bool all_shards_are_there() const {
    for (size_t k = 1; k <= shard_.count; ++k) {
      if (!std::filesystem::exists(files_.done_shard(k, shard_.count))) return false;
    }
    return true;
  }

  // Every design that no shard has done, and the table.
  void run_here() {
    RunEngine engine(task(files_.database()));
    for (const auto& shard : files_.shards(line_.collect)) engine.database().take_from(shard);
    const std::vector<size_t> all = designs_and_nominal(plan_);
    const std::vector<RunOutcome> outcomes =
        line_.collect ? collected(engine, all) : run_all(engine, all);
    write(engine, result_of(plan_, outcomes));
  }

  std::vector<RunOutcome> run_all(RunEngine& engine, const std::vector<size_t>& designs) {
    const std::vector<Changes> runs = runs_of_designs(plan_, designs);
    const std::vector<RunOutcome> outcomes = engine.outcomes(runs, console_.progress("designs"));
    console_.done();
    console_.line("  " + std::to_string(engine.made()) + " run now, " +
                  std::to_string(engine.kept()) + " kept from before");
    if (!designs.empty() && std::ranges::all_of(outcomes, &RunOutcome::failed)) {
      const size_t count = plan_.designs();
      const std::string& error = outcomes.front().error;
      if (outcomes.front().status == 3) throw NumericalError(error);
      throw in_design(line_, std::min(designs.front(), count - 1), count, error);
    }
    return outcomes;
  }

  std::vector<RunOutcome> collected(RunEngine& engine, const std::vector<size_t>& designs) {
    std::vector<RunOutcome> outcomes;
    size_t missing = 0;
    for (auto& kept : engine.kept_outcomes(runs_of_designs(plan_, designs))) {
      if (!kept) ++missing;
      outcomes.push_back(kept ? std::move(*kept) : RunOutcome{{}, 2, "not run yet"});
    }
    console_.line("  " + std::to_string(outcomes.size() - missing) + " runs collected, " +
                  std::to_string(missing) + " missing");
    if (missing == outcomes.size()) {
      throw InputError({files_.folder.string()}, "--collect", "no run of this sweep",
                       "the folder that its shards wrote into");
    }
    return outcomes;
  }

  void write(RunEngine& engine, const SweepResult& result) {
    // The last of several processes may be two.
    const Claims::Claim alone = engine.wait_for_others("table");
    Provenance provenance = build_provenance();
    provenance.inputs = file_.inputs;
    provenance.seed = file_.trace.seed;
    provenance.warnings = sweep_warnings(plan_, result);
    RunResult out{sweep_product(plan_, result), provenance, {}};
    const Changes best = result.best ? plan_.overrides(*result.best) : Changes{};
    print_best(console_, plan_, result, best);
    for (const std::string& warning : provenance.warnings) console_.line("WARNING: " + warning);
    if (result.best) {
      out.files.push_back(best_experiment(engine, best, *result.best));
    }
    engine.database().write_designs(out.product.tables.front());
    write_results(line_, console_, out);
  }

  RunFile best_experiment(RunEngine& engine, const Changes& changes, size_t design) const {
    std::string head = "# Design " + std::to_string(design + 1) + " of the sweep of " +
                       line_.experiment.filename().string() + ":\n";
    for (const std::string& change : changes) head += "#   " + change + "\n";
    const std::string text = engine.identity().experiment(changes, head, files_.folder);
    return {"best.toml",
            [text](const std::filesystem::path& path) { write_file_whole(path, text); },
            "the best design as an experiment"};
  }

  const CommandLine& line_;
  Console console_;
  ExperimentFile file_;
  SweepPlan plan_;
  Shard shard_;
  SweepFiles files_;
};

}  // namespace

Verb sweep_verb() {
  Verb verb{"sweep", "One command over many designs: any keys of the experiment, one table",
            [](const CommandLine& line) { SweepRun(line).run(); }, true};
  verb.takes_shard = true;
  return verb;
}

}  // namespace photorque
