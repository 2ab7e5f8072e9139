// photorque diagnose: what physics is missing between an experiment and its recordings.
#include <regex>

#include "diagnosis/attitude/diagnose.h"

#include "core/errors.h"
#include "core/files.h"
#include "diagnosis/light/diagnose.h"
#include "diagnosis/light/written.h"
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

// The text of an experiment with the files that it names found from another folder.
std::string seen_from(const std::string& text, const fs::path& experiment, const fs::path& folder) {
  static const std::regex quoted("\"([^\"\n]+)\"");
  std::string result;
  size_t done = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), quoted), end; it != end; ++it) {
    const fs::path file = fs::absolute(experiment).parent_path() / (*it)[1].str();
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) continue;
    const auto at = static_cast<size_t>(it->position());
    result += text.substr(done, at - done) + "\"" +
              file.lexically_proximate(fs::absolute(folder)).generic_string() + "\"";
    done = at + static_cast<size_t>(it->length());
  }
  return result + text.substr(done);
}

// Answer and files; the experiment's file gives improved.toml its text.
void write_diagnosis(const CommandLine& line, const Console& console, const Diagnosis& diagnosis,
                     const std::string& text, const Provenance& provenance) {
  print_diagnosis(console, diagnosis);
  const fs::path out = line.out_folder();
  const std::string json = diagnosis_json(diagnosis, provenance);
  const std::string improved = improved_experiment(text, diagnosis, fs::absolute(out));
  const std::string report = report_html(diagnosis, line.experiment.stem().string(), provenance,
                                         {plot_html, bar_chart_html});
  write_file_whole(out / "improved.toml", improved);
  write_file_whole(out / "report.html", report);
  write_file_whole(out / "diagnosis.json", json);
  console.line("Results in " + out.string());
  if (line.json) std::fwrite(json.data(), 1, json.size(), stdout);
}

std::vector<LightRecording> read_light(const std::vector<fs::path>& paths,
                                       const UsualCircumstances& usual, Provenance& provenance) {
  std::vector<LightRecording> all;
  for (const fs::path& path : paths) {
    all.push_back(read_light_recording(path, usual));
    provenance.inputs.emplace_back(path.filename().string(), content_hash(read_file(path)));
  }
  return all;
}

// Scans, sweeps and runs against lamps and array: no [platform] is needed.
void diagnose_light_recordings(const CommandLine& line, const Console& console) {
  const Experiment experiment = read_experiment(line.experiment, line.all_overrides());
  Provenance provenance = build_provenance();
  provenance.inputs = experiment.inputs;
  const LightLab lab(experiment);
  const LightState nominal = written_state(lab);
  const UsualCircumstances usual{experiment.lab_from_body.rotation,
                                 lab.has_array() ? lab.design().temperature_K : 298.15};
  std::vector<LightRecording> recordings = read_light(line.recordings, usual, provenance),
                              holdouts = read_light(line.holdouts, usual, provenance);
  LightDiagnoseOptions how;
  how.threads = line.threads;
  how.progress = [&](const std::string& what) { console.line("  " + what + " ..."); };
  const Diagnosis diagnosis =
      diagnose_light(lab, nominal, std::move(recordings), std::move(holdouts), how);
  write_diagnosis(line, console, diagnosis,
                  seen_from(read_file(line.experiment), line.experiment, line.out_folder()),
                  provenance);
}

void run_diagnose(const CommandLine& line) {
  Console console(line);
  if (line.recordings.empty()) {
    throw InputError({line.experiment.string()}, "--recording", "nothing", "a recording (CSV)");
  }
  // One recording of light among them, and all are meant to be.
  if (is_light_recording(line.recordings.front())) return diagnose_light_recordings(line, console);
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
  write_diagnosis(line, console, diagnosis, read_file(line.experiment), experiment.provenance(0));
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
