// photorque prove: injects effects in recordings, diagnoses them blind, and scores the answers.
#include <atomic>

#include "core/errors.h"
#include "core/files.h"
#include "core/parallel.h"
#include "images/publishing/staged_files.h"
#include "images/writers/product.h"
#include "images/writers/summary.h"
#include "scenes/experiment/toml_reader.h"
#include "tools/guards/child_process.h"
#include "tools/proof/files.h"
#include "tools/proof/light/files.h"
#include "tools/proof/settings.h"
#include "tools/scoring/blind_run.h"
#include "tools/scoring/case_files.h"
#include "tools/scoring/document.h"
#include "tools/verbs/verb.h"

namespace photorque::kinds::prove {
namespace {

namespace fs = std::filesystem;

struct Options : CommandOptions {
  std::optional<fs::path> cases;
  bool only_make = false;
};

void add_options(Command& command, Options& options) {
  command.add_experiment(options);
  command.add("--cases", options.cases, "Score this folder of cases instead of new ones");
  command.add("--only-make", options.only_make, "Make the cases, diagnose nothing");
}

struct ProveSettings {
  InjectedPlan plan;
  std::optional<LightPlan> light;  // cases of light and power instead of motion
  bool oracle = true;              // also diagnose with the truth told, for the held-out error
  bool replay = true;              // also propagate every improved.toml
  int at_once = 1;                 // diagnoses side by side
  double max_processor_s = 900.0;  // for one diagnosis
  size_t max_cases = 100000;
  std::optional<fs::path> document;  // whose section is renewed
  std::string section = "prove";
  std::string hash;  // of the settings
};

// Of light and power: what the two plans share, and `below`.
LightPlan light_plan_of(const InjectedPlan& shared, const Settings& prove) {
  LightPlan light;
  light.seed = shared.seed;
  light.per_kind = shared.per_kind;
  light.none = shared.none;
  light.pairs = shared.pairs;
  light.outside = shared.outside;
  light.below = static_cast<int>(prove.integer_or("below", light.below, 0, 100000));
  light.dirty_share = shared.dirty_fraction;
  return light;
}

// [prove] of the settings file; docs/proof.md says what the keys mean.
ProveSettings read_settings(const Options& line) {
  SettingsNode node = read_toml(line.experiment);
  for (const std::string& change : line.overrides) apply_override(node, change);
  const Settings root(std::make_shared<const SettingsNode>(std::move(node)));
  const Settings s = root.table("prove");
  ProveSettings settings;
  constexpr int64_t most = 100000;
  settings.plan = read_plan(s);
  if (line.seed) settings.plan.seed = *line.seed;
  if (s.choice_or("of", {"motion", "light"}, 0) == 1) {
    settings.light = light_plan_of(settings.plan, s);
  }
  settings.oracle = s.flag_or("oracle", settings.oracle);
  settings.replay = s.flag_or("replay", settings.replay);
  settings.at_once = static_cast<int>(s.integer_or("at_once", 1, 1, 1024));
  settings.max_processor_s = s.number_or("longest_s", settings.max_processor_s, Range::positive());
  settings.max_cases = static_cast<size_t>(s.integer_or("most_cases", most, 1, most));
  settings.section = s.text_or("section", settings.section);
  if (s.has("document")) {
    settings.document = line.experiment.parent_path() / s.text("document");
    if (!fs::is_regular_file(*settings.document)) {
      throw s.error("document", "no file " + settings.document->string(), "a page to renew");
    }
  }
  root.finish();
  settings.hash = content_hash(read_file(line.experiment));
  return settings;
}

std::string plan_text(const ProveSettings& settings);

// Cases that stand there are gone on with, but only those of the same plan.
void require_same_plan(const ProveSettings& settings, const fs::path& folder) {
  const fs::path note = folder / "plan.txt";
  const std::string plan = plan_text(settings) + "\n";
  if (fs::exists(note) && read_file(note) != plan) {
    throw InputError({folder.string()}, "--out",
                     "cases of another plan (" + note.filename().string() + ")",
                     "cases of this plan, or a new folder");
  }
  write_file_whole(note, plan);
}

// Makes the cases that are not there yet.
std::vector<fs::path> make_cases(const ProveSettings& settings, const fs::path& folder, int threads,
                                 const Console& console) {
  const size_t all = settings.light ? light_case_count(*settings.light) : case_count(settings.plan);
  const size_t count = std::min(all, settings.max_cases);
  require_same_plan(settings, folder);
  std::vector<fs::path> folders(count);
  std::atomic<size_t> done = 0;
  const auto progress = console.progress("injecting");
  parallel_for(count, threads, [&](size_t i) {
    char number[16];
    std::snprintf(number, sizeof number, "%04zu", i + 1);
    folders[i] = folder / number;
    if (!is_case(folders[i]) && settings.light) {
      write_light_case(draw_light_case(*settings.light, i), folders[i]);
    } else if (!is_case(folders[i])) {
      write_injected_case(draw_case(settings.plan, i), folders[i]);
    }
    ++done;
    if (progress) progress(static_cast<double>(done) / static_cast<double>(count));
  });
  console.done();
  return folders;
}

// Whether the program given the truth can say how well these recordings can be predicted.
bool has_oracle(const fs::path& case_folder, const CaseScore& score) {
  return score.verdict == "missing_physics" && !is_outside(score) &&
         fs::exists(case_folder / "oracle.toml");
}

std::vector<CaseScore> diagnose_and_score(const std::vector<fs::path>& folders,
                                          const ProveSettings& settings, const Options& line,
                                          const Console& console) {
  const fs::path out = line.out_folder();
  const BlindRun how{content_hash(read_file(own_program())), settings.replay,
                     settings.max_processor_s, std::max(1, line.threads)};
  BlindRun told = how;
  told.replay = false;
  std::vector<CaseScore> scores(folders.size());
  std::atomic<size_t> done = 0;
  const auto progress = console.progress("diagnosing");
  parallel_for(folders.size(), settings.at_once, [&](size_t i) {
    const std::string name = folders[i].filename().string();
    const fs::path blind = out / "blind" / name, oracle = out / "oracle" / name;
    diagnose_blind(folders[i], "experiment.toml", blind, how);
    CaseScore score = score_case(folders[i], blind / "diagnosis", oracle / "diagnosis");
    if (settings.oracle && has_oracle(folders[i], score)) {
      diagnose_blind(folders[i], "oracle.toml", oracle, told);
      score = score_case(folders[i], blind / "diagnosis", oracle / "diagnosis");
    }
    scores[i] = std::move(score);
    ++done;
    if (progress) progress(static_cast<double>(done) / static_cast<double>(folders.size()));
  });
  console.done();
  return scores;
}

Product proof_product(const std::vector<CaseScore>& scores) {
  Product product;
  product.quantities = proof_quantities(scores);
  product.tables = {proof_summary(scores),     proof_by_family(scores),   proof_by_kind(scores),
                    proof_reliability(scores), proof_calibration(scores), proof_cases(scores)};
  return product;
}

void print_proof(const Console& console, const std::vector<CaseScore>& scores) {
  for (const CaseScore& s : scores) {
    if (s.right) continue;
    const auto list = [](const std::vector<std::string>& names) {
      std::string text;
      for (const std::string& name : names) text += " " + name;
      return text.empty() ? " nothing" : text;
    };
    console.line("  wrong: " + s.name + ": " + s.true_verdict + list(s.true_kinds) + "; said " +
                 (s.answered ? s.verdict + list(s.kinds) : "nothing, " + s.failure));
  }
  console.heading("Proof");
  for (const ProofRow& row : proof_rows(scores)) {
    char text[160];
    std::snprintf(text, sizeof text, "%4d of %4d  %5.1f %%  (%.1f to %.1f)  ", row.fraction.hits,
                  row.fraction.of, 100.0 * row.fraction.hits / row.fraction.of,
                  100.0 * row.fraction.low(), 100.0 * row.fraction.high());
    console.line("  " + (text + row.question));
  }
  for (const Quantity& q : proof_quantities(scores)) {
    console.line("  " + q.name + " " + show(q.estimate, ""));
  }
}

std::string counted(int count, const std::string& what) {
  return count > 0 ? std::to_string(count) + " " + what + ", " : "";
}

std::string light_plan_text(const LightPlan& p) {
  std::string text = counted(p.per_kind, "of every kind") + counted(p.pairs, "pairs") +
                     counted(p.none, "with nothing missing") +
                     counted(p.outside, "of every law outside the catalogue") +
                     counted(p.below, "below what shows");
  if (!text.empty()) text.replace(text.size() - 2, 2, "; ");
  return text + show(100.0 * p.dirty_share) + " % of the files dirty; seed " +
         std::to_string(p.seed) + ".";
}

std::string plan_text(const ProveSettings& s) {
  if (s.light) return light_plan_text(*s.light);
  const InjectedPlan& p = s.plan;
  std::string rates;
  for (const double rate : p.rates_Hz) rates += (rates.empty() ? "" : ", ") + show(rate);
  std::string text = counted(p.per_kind, "of every kind") + counted(p.pairs, "pairs") +
                     counted(p.triples, "triples") +
                     counted(p.known_unknown, "with a known effect and an unknown law") +
                     counted(p.outside, "of every law outside the catalogue") +
                     counted(p.none, "with nothing missing") +
                     counted(p.noise_none, "with nothing missing and noise not as stated") +
                     counted(p.noise_effect, "of one effect under correlated noise");
  if (!text.empty()) text.replace(text.size() - 2, 2, "; ");
  return text + show(100.0 * p.second_fraction) +
         " % of the second maker, the others recordings of " + show(p.duration_s) +
         " s and hold-outs of " + show(p.holdout_s) + " s at " + rates + " Hz, " +
         show(100.0 * p.dirty_fraction) + " % of the files dirty; seed " + std::to_string(p.seed) +
         ".";
}

// Of out/light/cases "light": that its folder holds cases is said already.
std::string name_of_cases(const std::filesystem::path& folder) {
  const std::filesystem::path whole = std::filesystem::absolute(folder / ".").parent_path();
  return (whole.filename() == "cases" ? whole.parent_path() : whole).filename().string();
}

void run(const Options& line, const Program&) {
  const Console console = terminal(line);
  const ProveSettings settings = read_settings(line);
  const fs::path out = line.out_folder();
  const std::vector<fs::path> folders =
      line.cases ? cases_in(*line.cases)
                 : make_cases(settings, out / "cases", line.threads, console);
  console.line(std::to_string(folders.size()) + " cases");
  if (line.only_make) return;
  const auto scores = diagnose_and_score(folders, settings, line, console);
  print_proof(console, scores);

  Provenance provenance = build_provenance();
  provenance.seed = settings.plan.seed;
  provenance.inputs = {{line.experiment.filename().string(), settings.hash}};
  const ProofSet set{
      line.cases ? "Cases of " + name_of_cases(*line.cases) : "Cases made by this command",
      line.cases ? std::to_string(scores.size()) + " cases." : plan_text(settings), scores};
  const std::string text = proof_markdown(set);
  const Product product = proof_product(scores);
  StagedFiles staged(out);
  write_formats(product, provenance, staged.path(), {"csv", "json"});
  write_file_whole(staged.path() / "summary.json", summary_json(product, provenance));
  write_file_whole(staged.path() / "proof.md", text);
  staged.publish_as(line.verb, provenance);
  if (settings.document) {
    const std::string old = read_file(*settings.document);
    write_file_whole(*settings.document,
                     with_section(old, settings.section, text, settings.document->string()));
  }
  if (line.json) std::fputs(summary_json(product, provenance).c_str(), stdout);
  console.heading("Written to " + out.string());
}

}  // namespace

Verb kind() {
  return {"prove",
          "Inject effects in recordings, diagnose them blind, score the answers",
          command_with(add_options, run),
          {"prove"},
          "[prove]"};
}

}  // namespace photorque::kinds::prove
