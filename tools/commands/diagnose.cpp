// photorque diagnose: what physics is missing between an experiment and its recordings.
#include "diagnosis/attitude/diagnose.h"

#include "core/errors.h"
#include "core/files.h"
#include "diagnosis/report/improved.h"
#include "diagnosis/report/json.h"
#include "diagnosis/report/page.h"
#include "images/drawing/bar_chart.h"
#include "images/drawing/plot_picture.h"
#include "tools/runs/attitude_run.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

std::vector<NamedRecording> read_all(const std::vector<fs::path>& paths,
                                     const RecordingOptions& options,
                                     AttitudeExperiment& experiment) {
  std::vector<NamedRecording> all;
  for (const fs::path& path : paths) {
    experiment.add_input(path);
    all.push_back({path.string(), read_recording(path, options)});
  }
  return all;
}

void print_diagnosis(const Console& console, const Diagnosis& d) {
  console.line(d.sentence);
  for (const FoundEffect& effect : d.effects) {
    console.line("  " + effect.kind + ", probability " + show(effect.probability));
    for (const FittedParameter& p : effect.parameters) {
      std::string text = "    " + p.key + " ";
      for (size_t i = 0; i < p.value.size(); ++i) {
        text += (i > 0 ? ", " : "= ") + show(Estimate{p.value[i], p.sigma[i]}, "");
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
  Console console(line);
  if (line.recordings.empty()) {
    throw InputError({line.experiment.string()}, "--recording", "nothing", "a recording (CSV)");
  }
  AttitudeExperiment experiment(line);
  const NominalModel nominal = read_attitude_model(experiment.settings());
  const Settings recording = own_table(experiment.settings(), "recording", false);
  const RecordingOptions options = read_recording_options(recording);
  recording.finish();
  const std::vector<NamedRecording> recordings = read_all(line.recordings, options, experiment);
  const std::vector<NamedRecording> holdouts = read_all(line.holdouts, options, experiment);

  DiagnoseOptions how;
  how.threads = line.threads;
  how.progress = [&](const std::string& what) { console.line("  " + what + " ..."); };
  const Diagnosis diagnosis = diagnose(nominal, recordings, holdouts, how);
  print_diagnosis(console, diagnosis);

  const fs::path out = line.out_folder();
  const Provenance provenance = experiment.provenance(0);
  const std::string json = diagnosis_json(diagnosis, provenance);
  const std::string improved =
      improved_experiment(read_file(line.experiment), diagnosis, fs::absolute(out));
  const std::string report = report_html(diagnosis, line.experiment.stem().string(), provenance,
                                         {plot_html, bar_chart_html});
  write_file_whole(out / "improved.toml", improved);
  write_file_whole(out / "report.html", report);
  write_file_whole(out / "diagnosis.json", json);
  console.line("Results in " + out.string());
  if (line.json) std::fwrite(json.data(), 1, json.size(), stdout);
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
