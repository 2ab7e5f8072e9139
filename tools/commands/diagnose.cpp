// photorque diagnose: what physics is missing between an experiment and its recordings.
#include "tools/tasks/diagnose.h"

#include <cstdio>

#include "core/errors.h"
#include "core/files.h"

#include "tools/commands/page.h"
#include "tools/commands/terminal.h"
#include "tools/pages/pages.h"

namespace photorque::kinds::diagnose {
namespace {

void print_diagnosis(const Console& console, const Diagnosis& d) {
  console.line(d.sentence);
  for (const FoundEffect& effect : d.effects) {
    console.line("  " + effect.kind + ", probability " + show(effect.probability));
    for (const FittedParameter& p : effect.parameters) {
      std::string text = "    " + p.key + " ";
      for (size_t i = 0; i < p.value.size(); ++i) {
        const double sigma = i < p.sigma.size() ? p.sigma[i] : 0.0;
        text += (i > 0 ? ", " : "= ") + show(Estimate{p.value[i], sigma}, "");
      }
      console.line(text);
    }
    for (const std::string& text : effect.known_together) {
      console.line("    known together, none by itself: " + text);
    }
    for (const auto& [key, words] : effect.texts) console.line("    " + key + " = " + words);
    for (const std::string& rival : effect.indistinguishable_from) {
      console.line("    these data do not tell it from " + rival);
    }
  }
  console.line("  chi² per sample " + show(d.chi2_per_sample_before) + " before, " +
               show(d.chi2_per_sample_after) + " after");
  if (d.holdout) {
    console.line("  never fitted:    " + show(d.holdout->chi2_per_sample_before) + " before, " +
                 show(d.holdout->chi2_per_sample_after) + " after");
  }
  for (const std::string& warning : d.warnings) console.line("  note: " + warning);
}

// All that is printed is an experiment too.
void write_guess(const CommandLine& line) {
  const Console console = terminal(line);
  const std::filesystem::path file = line.out_folder() / (line.name_of_guess().string() + ".toml");
  const std::string text = first_experiment(line.guess, file);
  // Somebody may have confirmed what stands there.
  if (std::filesystem::exists(file) && read_file(file) != text) {
    throw InputError({file.string()}, "", "another file of this name",
                     "a folder without one (--out DIR)");
  }
  write_file_whole(file, text);
  console.line(text);
  console.line("# Written to " + file.string() + ". Next, as it is or confirmed:");
  std::string next = "# photorque diagnose " + file.string();
  for (const std::filesystem::path& recording : line.guess) {
    next += " --recording " + recording.string();
  }
  console.line(next);
}

void run_diagnose(const CommandLine& line) {
  if (!line.guess.empty()) return write_guess(line);
  const Console console = terminal(line);
  const DiagnosisRun run = diagnose_experiment(line, line.recordings, line.holdouts, console);
  print_diagnosis(console, run.diagnosis);
  const std::string report =
      line.page ? interactive_report_html(run, line, page_head(line)) : report_html(run);
  write_diagnosis(run, report, line.out_folder());
  console.line("Results in " + line.out_folder().string());
  if (!line.json) return;
  const std::string json = run.json();
  std::fwrite(json.data(), 1, json.size(), stdout);
}

}  // namespace

Verb kind() {
  Verb verb{"diagnose", "What physics is missing between an experiment and its recordings",
            run_diagnose};
  verb.takes_recordings = true;
  verb.takes_holdouts = true;
  verb.takes_guess = true;
  verb.draws_page = true;
  return verb;
}

}  // namespace photorque::kinds::diagnose
