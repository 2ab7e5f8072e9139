// photorque sweep: one command over many designs, with the results in one table.
#include <algorithm>

#include "tools/verbs/studies.h"

namespace photorque::verbs::sweep {
namespace {

struct Options : CommandOptions {
  std::string shard;
  bool collect = false;
};

void add_options(Command& command, Options& options) {
  command.add_traced_experiment(options, Command::Folder::shared);
  command.add("--shard", options.shard,
              "Compute every Nth design, starting with the Kth (K/N); the last shard that ends "
              "writes the table");
  command.add(
      "--collect", options.collect,
      "Write the table of the existing results without computing, also of incomplete shards");
}

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
    throw InputError({"--shard"}, "", '"' + text + '"', "K/N with 1 <= K <= N");
  }
  return {k, n};
}

class SweepRun {
 public:
  SweepRun(const Options& options, const std::vector<Verb>& verbs)
      : options_(options),
        verbs_(verbs),
        console_(terminal(options)),
        file_(read_experiment_file(options.experiment, options.all_overrides())),
        plan_(read_study_plan(file_, verbs)),
        shard_(read_shard(options.shard)),
        files_{options.out_folder()} {}

  void run() {
    if (plan_.designs() == 0) {
      throw file_.settings.error("sweep.axis", "from and to alone",
                                 "count as well, or `photorque optimise`");
    }
    const size_t copies = plan_.built.of_every ? plan_.built.copies + 1 : 1;
    const size_t each = plan_.mean_points() * plan_.worst_points() * copies;
    console_.heading(std::to_string(plan_.designs()) + " designs by `" + plan_.verb + '`' +
                     (each > 1 ? ", " + std::to_string(each) + " runs each" : ""));
    if (!options_.collect && !options_.shard.empty()) {
      run_shard();
      if (!has_all_shards()) {
        console_.line("  not all shards are done; the table is written by the last");
        return;
      }
    }
    run_here();
  }

 private:
  // Computes every design of this shard in the shard's own database, and writes a copy of it at the
  // end.
  void run_shard() {
    std::vector<size_t> own = all_designs();
    std::erase_if(own, [this](size_t design) { return !shard_.takes(design); });
    RunEngine engine(
        study_task(options_, plan_, verbs_, files_.shard(shard_.number, shard_.count)));
    const DesignEvaluator evaluator(plan_, engine);
    run_all(engine, evaluator, own);
    if (engine.has_database()) {
      engine.database().copy_to(files_.done_shard(shard_.number, shard_.count));
    }
  }

  bool has_all_shards() const {
    for (size_t k = 1; k <= shard_.count; ++k) {
      if (!std::filesystem::exists(files_.done_shard(k, shard_.count))) return false;
    }
    return true;
  }

  // Computes every design that is not in a shard, and writes the table.
  void run_here() {
    RunEngine engine(study_task(options_, plan_, verbs_, files_.database()));
    for (const auto& shard : files_.shards(options_.collect)) engine.database().take_from(shard);
    const DesignEvaluator evaluator(plan_, engine);
    const std::vector<size_t> all = all_designs();
    SweepResult result{evaluator.designs_of(options_.collect ? collected(engine, evaluator, all)
                                                             : run_all(engine, evaluator, all))};
    if (result.designs.size() > plan_.designs()) {
      result.nominal = std::move(result.designs.back());
      result.designs.pop_back();
    }
    finish_study({options_, console_, file_, plan_, engine, std::move(result)}, !options_.collect);
  }

  // With an objective, the nominal experiment is an additional design.
  std::vector<size_t> all_designs() const {
    std::vector<size_t> all(plan_.designs() + (plan_.objectives.empty() ? 0 : 1));
    for (size_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
  }

  std::vector<Changes> runs_of(const DesignEvaluator& evaluator,
                               const std::vector<size_t>& designs) const {
    std::vector<Changes> changes;
    for (const size_t d : designs) {
      changes.push_back(d < plan_.designs() ? plan_.overrides(d) : Changes{});
    }
    return evaluator.runs_of(changes);
  }

  std::vector<RunOutcome> run_all(RunEngine& engine, const DesignEvaluator& evaluator,
                                  const std::vector<size_t>& designs) const {
    const std::vector<RunOutcome> outcomes =
        engine.outcomes(runs_of(evaluator, designs), console_.progress("designs"));
    console_.done();
    console_.line("  " + std::to_string(engine.made()) + " run now, " +
                  std::to_string(engine.kept()) + " kept from before");
    if (!designs.empty() && std::ranges::all_of(outcomes, &RunOutcome::failed)) {
      throw_failed_study(options_, outcomes.front(), designs.front(), plan_.designs());
    }
    return outcomes;
  }

  std::vector<RunOutcome> collected(RunEngine& engine, const DesignEvaluator& evaluator,
                                    const std::vector<size_t>& designs) const {
    std::vector<RunOutcome> outcomes;
    size_t missing = 0;
    for (auto& kept : engine.kept_outcomes(runs_of(evaluator, designs))) {
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

  const Options& options_;
  const std::vector<Verb>& verbs_;
  Console console_;
  ExperimentFile file_;
  SweepPlan plan_;
  Shard shard_;
  SweepFiles files_;
};

void run(const Options& options, const Program& program) {
  SweepRun(options, program.verbs).run();
}

}  // namespace

Verb kind() {
  return {"sweep",
          "One command for many designs, with all results in one table",
          command_with(add_options, run),
          {"sweep"},
          "[sweep]"};
}

}  // namespace photorque::verbs::sweep
