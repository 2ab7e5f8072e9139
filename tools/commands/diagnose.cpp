// photorque diagnose: what physics is missing between an experiment and its recordings.
#include "tools/tasks/diagnose.h"

#include <cstdio>

#include "tools/commands/terminal.h"

namespace photorque {
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

void run_diagnose(const CommandLine& line) {
  const Console console = terminal(line);
  const DiagnosisRun run = diagnose_experiment(line, line.recordings, line.holdouts, console);
  print_diagnosis(console, run.diagnosis);
  write_diagnosis(run, line.out_folder());
  console.line("Results in " + line.out_folder().string());
  if (!line.json) return;
  const std::string json = run.json();
  std::fwrite(json.data(), 1, json.size(), stdout);
}

}  // namespace

Verb diagnose_verb() {
  Verb verb{"diagnose", "What physics is missing between an experiment and its recordings",
            run_diagnose};
  verb.takes_recordings = true;
  verb.takes_holdouts = true;
  return verb;
}

}  // namespace photorque
