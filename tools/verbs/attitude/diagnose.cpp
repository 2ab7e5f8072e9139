// photorque diagnose: effects that are missing in an experiment, from its recordings.
#include "tools/verbs/attitude/diagnose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <set>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "diagnosis/attitude/diagnose.h"
#include "diagnosis/guess/guess.h"
#include "diagnosis/improved.h"
#include "diagnosis/json.h"
#include "diagnosis/light/diagnose.h"
#include "diagnosis/light/module/diagnose.h"
#include "diagnosis/light/nominal_light.h"
#include "diagnosis/light/together.h"
#include "images/writers/product.h"
#include "images/writers/staged_files.h"
#include "scenes/experiment/document.h"
#include "scenes/experiment/named_files.h"
#include "scenes/experiment/toml.h"
#include "tools/pages/pages.h"
#include "tools/runs/attitude_run.h"
#include "tools/verbs/verb.h"

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

// The text with the overrides of the command line.
std::string with_overrides(const std::string& text, const std::vector<std::string>& overrides) {
  if (overrides.empty()) return text;
  TomlDocument document(text, "");
  for (const std::string& assignment : overrides) {
    apply_override(document.root, assignment);
    document.add_to_head("--set " + assignment);
  }
  return document.text();
}

// Whether a recording is of light. For an experiment with a platform alone, a log of a machine with
// its voltage and current is not.
bool is_of_light(const fs::path& path, const RecordingOptions& reading, bool of_platform) {
  if (!is_light_recording(path, reading)) return false;
  if (!of_platform) return true;
  try {
    read_recording(path, reading);
  } catch (const InputError&) {
    return true;  // it has no time
  }
  return false;
}

// Whether the recordings are of light. Throws InputError for the first recording of another kind.
bool are_of_light(const std::vector<fs::path>& recordings, const std::vector<fs::path>& holdouts,
                  const RecordingOptions& reading, bool of_platform) {
  const bool of_light = is_of_light(recordings.front(), reading, of_platform);
  for (const auto* all : {&recordings, &holdouts}) {
    for (const fs::path& path : *all) {
      if (!fs::exists(path) || is_of_light(path, reading, of_platform) == of_light) continue;
      throw InputError({path.string()}, "",
                       of_light ? "no column names of light" : "column names of light",
                       std::string("a recording of ") + (of_light ? "light" : "motion") + ", as " +
                           recordings.front().filename().string());
    }
  }
  return of_light;
}

std::vector<LightRecording> read_light(const std::vector<fs::path>& paths,
                                       const DefaultConditions& usual,
                                       const RecordingOptions& reading, Provenance& provenance) {
  std::vector<LightRecording> all;
  for (const fs::path& path : paths) {
    all.push_back(read_light_recording(path, usual, reading));
    provenance.inputs.emplace_back(path.filename().string(), content_hash(read_file(path)));
  }
  return all;
}

// [recording], where recordings of light are read.
RecordingOptions reading_in(const Settings& root) {
  const Settings recording = own_table(root, "recording", false);
  RecordingOptions options = read_recording_options(recording);
  recording.finish();
  return options;
}

// Throws InputError for named columns of [recording] that are missing in the recordings.
template <typename... Recordings>
void refuse_absent(const Settings& root, const Recordings&... lists) {
  std::vector<std::set<std::string>> all;
  const auto add = [&](const auto& list) {
    for (const auto& one : list) {
      if constexpr (requires { one.absent_columns; })
        all.push_back(one.absent_columns);
      else
        all.push_back(one.recording.report.absent_columns);
    }
  };
  (add(lists), ...);
  refuse_absent_columns(own_table(root, "recording", false), all);
}

using Progress = std::function<void(const std::string&)>;

Progress progress_on(const Console& console, const std::string& of) {
  return [&console, of](const std::string& what) { console.line("  " + of + what + " ..."); };
}

// Lamps and array of an experiment with their recordings.
struct LightInput {
  Experiment experiment;
  LightLab lab{experiment};
  NominalLight nominal{lab.nominal(), {}};
  std::vector<LightRecording> recordings = {}, holdouts = {};
  Provenance provenance = {};
};

std::unique_ptr<LightInput> read_light_input(const RunOptions& options,
                                             const std::vector<fs::path>& paths,
                                             const std::vector<fs::path>& holdout_paths,
                                             const RecordingOptions& reading) {
  const std::string text = options.experiment_text();
  const auto reread = [&](const std::string& assignment) {
    std::vector<std::string> overrides = options.all_overrides();
    if (!assignment.empty()) overrides.push_back(assignment);
    return resolve_experiment(read_experiment_text(options.experiment, text, overrides));
  };
  std::unique_ptr<LightInput> input(new LightInput{reread("")});
  input->provenance = build_provenance();
  input->provenance.inputs = input->experiment.inputs;
  input->nominal = nominal_light(
      input->lab, uncertain_keys(options.experiment, text, options.all_overrides()), reread);
  const DefaultConditions usual{
      input->experiment.lab_from_body.rotation,
      input->lab.has_array() ? input->lab.design().temperature_K : 298.15};
  input->recordings = read_light(paths, usual, reading, input->provenance);
  input->holdouts = read_light(holdout_paths, usual, reading, input->provenance);
  return input;
}

DiagnosisRun diagnose_light_recordings(const RunOptions& options, const Settings& root,
                                       const std::vector<fs::path>& paths,
                                       const std::vector<fs::path>& holdout_paths,
                                       const Console& console) {
  const auto input = read_light_input(options, paths, holdout_paths, reading_in(root));
  refuse_absent(root, input->recordings, input->holdouts);
  LightDiagnoseOptions how;
  how.threads = options.threads;
  how.progress = progress_on(console, "");
  Diagnosis diagnosis = diagnose_light(input->lab, input->nominal, std::move(input->recordings),
                                       std::move(input->holdouts), how);
  return {std::move(diagnosis), std::move(input->provenance), options.experiment,
          with_overrides(options.experiment_text(), options.all_overrides()), true};
}

// Diagnosis of current-voltage curves of a module in sunlight, which need no scene.
DiagnosisRun diagnose_module_curves(const RunOptions& options, const Settings& root,
                                    const std::vector<fs::path>& paths,
                                    const std::vector<fs::path>& holdout_paths) {
  const ModuleDesign design = read_module(root, options.experiment.parent_path());
  root.finish();
  Provenance provenance = build_provenance();
  const std::string text = options.experiment_text();
  provenance.inputs.emplace_back(options.experiment.filename().string(), content_hash(text));
  for (const fs::path& file : design.reference_files) {
    provenance.inputs.emplace_back(file.filename().string(), content_hash(read_file(file)));
  }
  const std::vector<LightRecording> recordings = read_light(paths, {}, design.reading, provenance),
                                    holdouts =
                                        read_light(holdout_paths, {}, design.reading, provenance);
  refuse_absent(root, design.references, recordings, holdouts);
  Diagnosis diagnosis = diagnose_module(design, recordings, holdouts, options.threads);
  return {std::move(diagnosis), std::move(provenance), options.experiment,
          with_overrides(text, options.all_overrides()), true};
}

MotionRecorded read_motion(const RunOptions& options, AttitudeExperiment& experiment,
                           const std::vector<fs::path>& paths,
                           const std::vector<fs::path>& holdout_paths) {
  MotionRecorded motion{read_attitude_model(experiment.settings()), {}, {}, {}};
  const Settings recording = own_table(experiment.settings(), "recording", false);
  const RecordingOptions reading = read_recording_options(recording);
  motion.recordings = read_all(paths, reading, experiment);
  motion.holdouts = read_all(holdout_paths, reading, experiment);
  recording.finish();
  motion.how.threads = options.threads;
  return motion;
}

DiagnosisRun diagnose_motion(const RunOptions& options, const std::vector<fs::path>& paths,
                             const std::vector<fs::path>& holdout_paths, const Console& console) {
  AttitudeExperiment experiment(options);
  MotionRecorded motion = read_motion(options, experiment, paths, holdout_paths);
  refuse_absent(experiment.settings(), motion.recordings, motion.holdouts);
  motion.how.progress = progress_on(console, "");
  Diagnosis diagnosis = diagnose(motion.nominal, motion.recordings, motion.holdouts, motion.how);
  return {std::move(diagnosis), experiment.provenance(0), options.experiment,
          with_overrides(options.experiment_text(), options.overrides), false};
}

// Recordings by their content. A recording of the array contains the motion of the platform, too.
struct Sorted {
  std::vector<fs::path> motion, light;
};

Sorted sorted_by_content(const std::vector<fs::path>& paths, const RecordingOptions& reading) {
  Sorted sorted;
  for (const fs::path& path : paths) {
    const std::optional<LightRecording::Kind> kind = light_kind_of(path, reading);
    if (kind) sorted.light.push_back(path);
    if (!kind || *kind == LightRecording::Kind::run) sorted.motion.push_back(path);
  }
  return sorted;
}

DiagnosisRun diagnose_both(const RunOptions& options, const Settings& root,
                           const Sorted& recordings, const Sorted& holdouts,
                           const Console& console) {
  AttitudeExperiment experiment(options);
  MotionRecorded motion = read_motion(options, experiment, recordings.motion, holdouts.motion);
  motion.how.progress = progress_on(console, "motion: ");
  motion.how.read_elsewhere = {"array_voltage_V", "array_current_A", "cell_temperature_K"};
  const auto input = read_light_input(options, recordings.light, holdouts.light, reading_in(root));
  refuse_absent(root, motion.recordings, motion.holdouts, input->recordings, input->holdouts);
  LightRecorded light{
      input->lab, input->nominal, std::move(input->recordings), std::move(input->holdouts), {}};
  light.how.threads = options.threads;
  light.how.progress = progress_on(console, "light: ");
  Diagnosis diagnosis = diagnose_together(std::move(motion), std::move(light));
  Provenance provenance = experiment.provenance(0);
  for (const auto& one : input->provenance.inputs) {
    if (std::ranges::find(provenance.inputs, one) == provenance.inputs.end()) {
      provenance.inputs.push_back(one);
    }
  }
  return {std::move(diagnosis), std::move(provenance), options.experiment,
          with_overrides(options.experiment_text(), options.all_overrides()), true};
}

}  // namespace

std::string DiagnosisRun::json() const {
  return diagnosis_json(diagnosis, provenance);
}

std::string DiagnosisRun::improved(const fs::path& folder) const {
  TomlDocument document(text, experiment.string());
  name_files_from(document.root, experiment.parent_path(), folder);
  return improved_experiment(std::move(document), diagnosis, folder);
}

std::string DiagnosisRun::report() const {
  return report_html(diagnosis, provenance, experiment.stem().string());
}

// Rejects repeated recordings, and held-out recordings that are also fitted.
void require_each_once(const std::vector<fs::path>& recordings,
                       const std::vector<fs::path>& holdouts) {
  std::vector<fs::path> known;
  for (const auto* all : {&recordings, &holdouts}) {
    for (const fs::path& path : *all) {
      if (!fs::exists(path)) continue;
      const bool is_known = std::ranges::any_of(
          known, [&](const fs::path& other) { return fs::equivalent(path, other); });
      if (is_known) {
        throw InputError({path.string()}, all == &holdouts ? "--holdout" : "--recording",
                         "a file that is given twice", "another recording");
      }
      known.push_back(path);
    }
  }
}

DiagnosisRun run_diagnose(const RunOptions& options, const std::vector<fs::path>& recordings,
                          const std::vector<fs::path>& holdouts, const Console& console) {
  if (recordings.empty()) {
    throw InputError({options.experiment.string()}, "--recording", "nothing", "a recording (CSV)");
  }
  require_each_once(recordings, holdouts);
  const Settings root(options.settings(options.all_overrides()));
  if (root.has("module")) return diagnose_module_curves(options, root, recordings, holdouts);
  const RecordingOptions reading = reading_in(root);
  const Sorted sorted = sorted_by_content(recordings, reading);
  if (root.has("platform") && root.has("scene") && !sorted.light.empty() &&
      !sorted.motion.empty()) {
    return diagnose_both(options, root, sorted, sorted_by_content(holdouts, reading), console);
  }
  // Without a platform the files must be of light: their reader reports other files.
  const bool of_platform = root.has("platform") && !root.has("scene");
  return are_of_light(recordings, holdouts, reading, of_platform) ||
                 (root.has("scene") && !root.has("platform"))
             ? diagnose_light_recordings(options, root, recordings, holdouts, console)
             : diagnose_motion(options, recordings, holdouts, console);
}

namespace {

// The text of a first experiment for recordings without one, to be written to `file`. Throws
// InputError if `diagnose` could not read it.
std::string first_experiment(const std::vector<fs::path>& recordings, const fs::path& file,
                             const RecordingOptions& reading) {
  const std::string text = guess_experiment(recordings, file.parent_path(), reading);
  const Settings root(parse_toml(text, file.string()));
  if (root.has("module")) {
    read_module(root, file.parent_path());
  } else {
    read_attitude_model(root);
    reading_in(root);
  }
  root.finish();
  return text;
}

}  // namespace

void write_diagnosis(const DiagnosisRun& run, const std::string& report, const fs::path& folder,
                     const RunFormats& formats) {
  const std::string json = run.json(), improved = run.improved(folder);
  StagedFiles staged(folder);
  if (!formats.further.empty()) {
    write_formats(diagnosis_figures(run.diagnosis, run.of_light), run.provenance, staged.path(),
                  formats.further, formats.style);
  }
  write_file_whole(staged.path() / "improved.toml", improved);
  write_file_whole(staged.path() / "report.html", report);
  write_file_whole(staged.path() / "diagnosis.json", json);
  staged.publish_as("diagnose", run.provenance);
}

}  // namespace photorque

namespace photorque::verbs::diagnose {
namespace {

struct Options : CommandOptions {
  std::vector<std::filesystem::path> recordings, holdouts;
  std::vector<std::filesystem::path> guess;  // recordings without an experiment
  std::string columns;                       // of these: names separated by commas
  std::optional<double> rate_Hz;             // of these: rows per second
};

// Name of the guessed experiment: "run1" for data/run1.csv.gz.
std::string name_of_guess(const std::vector<std::filesystem::path>& guess) {
  std::filesystem::path name = guess.front().filename();
  while (name.has_extension()) name = name.stem();
  return name.string();
}

void add_options(Command& command, Options& options) {
  command.add_experiment(options, Command::Folder::own, false);
  command.add_recordings(options.recordings);
  command
      .add("--holdout", options.holdouts,
           "A held-out recording (CSV), which tests the result; may be repeated")
      .is_one_each = true;
  command.add("--guess", options.guess,
              "Write a first experiment for these recordings (CSV), with its assumptions marked");
  command.add("--columns", options.columns,
              "With --guess: names of the columns: t_s,angle_deg. For files without a header, or "
              "with several bodies");
  command
      .add("--rate-Hz,--fps", options.rate_Hz,
           "With --guess: rows or video frames per second of files without a time")
      .range = Option::Between<double>{1e-9, 1e9};
  command.add("--page", options.page, "Write report.html with interactive scene, maps and curves");
  command.mistake = [&options]() -> std::string {
    if (!options.guess.empty()) options.name = name_of_guess(options.guess);
    if (options.guess.empty() && (!options.columns.empty() || options.rate_Hz)) {
      return "--columns and --rate-Hz are for --guess; an experiment states header and rate_Hz in "
             "[recording]";
    }
    if (options.experiment.empty() != options.guess.empty()) return "";
    return options.guess.empty() ? "experiment is required, or --guess RECORDING"
                                 : "both an experiment and --guess";
  };
}

void print_diagnosis(const Console& console, const Diagnosis& d) {
  // Names of nodes and columns may contain line ends.
  const auto print = [&](const std::string& text) { console.line(clean_text(text)); };
  print(d.sentence);
  for (const FoundEffect& effect : d.effects) {
    const std::string others = joined_text(effect.indistinguishable_from, " or ");
    print("  " + effect.kind + (others.empty() ? "" : " or " + others) + ", probability " +
          show(1e-3 * std::round(1e3 * effect.probability)));
    for (const FittedParameter& p : effect.parameters) {
      std::string text = "    " + p.key + " ";
      for (size_t i = 0; i < p.value.size(); ++i) {
        const double sigma = i < p.sigma.size() ? p.sigma[i] : 0.0;
        text += (i > 0 ? ", " : "= ") + show(Estimate{p.value[i], sigma}, "");
      }
      print(text);
    }
    for (const std::string& text : effect.known_together) {
      print("    only this combination is identifiable: " + text);
    }
    for (const auto& [key, words] : effect.texts) print("    " + key + " = " + words);
  }
  print("  chi² per sample " + readable_number(d.chi2_per_sample_before) + " before, " +
        readable_number(d.chi2_per_sample_after) + " after");
  if (d.holdout) {
    print("  held out:        " + readable_number(d.holdout->chi2_per_sample_before) + " before, " +
          readable_number(d.holdout->chi2_per_sample_after) + " after");
  }
  for (const std::string& warning : d.warnings) print("  note: " + warning);
}

// Writes the guessed experiment; the printed text is the same experiment.
void write_guess(const Options& options) {
  const Console console = terminal(options);
  const std::filesystem::path file = options.out_folder() / (options.name + ".toml");
  RecordingOptions reading;
  for (const std::string_view name : cells_of(options.columns)) {
    if (!options.columns.empty()) reading.header.emplace_back(name);
  }
  reading.rate_Hz = options.rate_Hz;
  const std::string text = first_experiment(options.guess, file, reading);
  // The user may have edited the file.
  if (std::filesystem::exists(file) && read_file(file) != text) {
    throw InputError({file.string()}, "", "another file of this name",
                     "a folder without one (--out DIR)");
  }
  write_file_whole(file, text);
  console.line(text);
  console.line("# Written to " + clean_text(file.string()) + ". Next, as it is or confirmed:");
  std::string next = "# photorque diagnose " + shell_word(file.string());
  for (const std::filesystem::path& recording : options.guess) {
    next += " --recording " + shell_word(recording.string());
  }
  console.line(next);
}

void run(const Options& options, const Program&) {
  if (!options.guess.empty()) return write_guess(options);
  const Console console = terminal(options);
  const RunFormats formats = formats_of(options);
  const DiagnosisRun run = run_diagnose(options, options.recordings, options.holdouts, console);
  print_diagnosis(console, run.diagnosis);
  const std::string report =
      options.page
          ? interactive_report_html(run.diagnosis, run.provenance, run.of_light, options,
                                    page_head(options, options.recordings, options.holdouts))
          : run.report();
  write_diagnosis(run, report, options.out_folder(), formats);
  console.line("Results in " + options.out_folder().string());
  if (!options.json) return;
  const std::string json = run.json();
  std::fwrite(json.data(), 1, json.size(), stdout);
}

}  // namespace

Verb kind() {
  return {"diagnose",
          "Physical effects that an experiment lacks, from recordings",
          command_with(add_options, run),
          {"array", "effect", "platform", "environment", "disturbance", "sensors", "recording",
           "module"},
          "[platform], [module] or [sensors] of light"};
}

}  // namespace photorque::verbs::diagnose
