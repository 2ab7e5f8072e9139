// photorque check: all checks of an experiment that need no run.
#include "tools/verbs/check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "attitude/camera/study.h"
#include "attitude/disturbances/mass/moving_masses.h"
#include "attitude/filtering/study.h"
#include "attitude/propagation/run.h"
#include "attitude/recordings/recording.h"
#include "attitude/studies/budget.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "diagnosis/light/model/lab.h"
#include "diagnosis/light/module/design.h"
#include "tools/coupling/couple.h"
#include "tools/keys/registry.h"
#include "tools/realtime/session.h"
#include "tools/runs/array_power.h"
#include "tools/runs/attitude_run.h"
#include "tools/runs/optical_run.h"
#include "tools/sweeps/plan.h"
#include "tools/verbs/fit_cell.h"
#include "tools/verbs/supply.h"
#include "tools/verbs/verb.h"

namespace photorque {
namespace {

std::string counted(size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// Table of a mistake: "source[0]" from "lab.toml:18: source[0].power_W: found …".
std::string table_of(const InputError& mistake) {
  std::string line = mistake.what();
  const size_t end = std::min(line.find(": found "), line.find(": expected "));
  if (end != std::string::npos) line.resize(end);
  const size_t colon = line.rfind(": ");
  if (colon != std::string::npos) line.erase(0, colon + 2);
  return line.substr(0, line.find('.'));
}

// The lamps of one [[source]]: their names are NAME or NAME[0], NAME[1], …
std::vector<Beam> beams_of(const Experiment& experiment, const Settings& source) {
  const std::string name = source.text_or("name", source.text_or("kind", ""));
  std::vector<Beam> beams;
  for (const Beam& beam : experiment.beams) {
    if (beam.name == name || beam.name.starts_with(name + "[")) beams.push_back(beam);
  }
  return beams;
}

struct FewRays {
  InsideLightReceiver inside;
  std::vector<const Receiver*> receivers;  // those of the experiment, then `inside`
  TraceOptions options;

  explicit FewRays(const Experiment& experiment)
      : inside(experiment.scene), receivers(experiment.receiver_pointers()) {
    receivers.push_back(&inside);
    options = experiment.file.trace;
    options.replicates = 8;
    options.rays = 16384;
  }
};

// Fraction of the power that a source sends to the scene: more than the loss through cracks, less
// than one lamp of a thousand.
constexpr double noticeable = 1e-3;

std::string inside_of(const Experiment& experiment, const InsideLightReceiver& inside,
                      const BinSums& sums, double sent_W) {
  for (const auto& part : inside.lit_inside(sums)) {
    if (part.inside_W.value > noticeable * sent_W) {
      return experiment.scene.instances[part.instance].path;
    }
  }
  return "";
}

// Whether the faces of a part point inwards: then the enclosed volume (sum of the tetrahedra from
// the origin to each face) is negative.
bool is_turned_inwards(const Scene& scene, const std::string& path) {
  double six_volumes_m3 = 0.0;
  for (const Instance& instance : scene.instances) {
    if (instance.path != path) continue;
    const Mesh& mesh = scene.meshes[instance.mesh];
    // A mirrored instance is traced with reversed winding.
    const double sign = instance.body_from_mesh.linear().determinant() < 0.0 ? -1.0 : 1.0;
    for (const auto& face : mesh.triangles) {
      const auto corner = [&](size_t k) {
        return Vec3(instance.body_from_mesh * mesh.vertices_m[face[k]]);
      };
      six_volumes_m3 += sign * corner(0).dot(corner(1).cross(corner(2)));
    }
  }
  return six_volumes_m3 < 0.0;
}

// Whether a source has a position; the light of a sun starts outside all parts.
bool has_place(const std::vector<Beam>& beams) {
  return std::ranges::any_of(beams, [](const Beam& beam) {
    return !beam.aperture || !std::isinf(beam.aperture->radius_m);
  });
}

double lit_W(const NamedReceiver& receiver, const BinSums& sums) {
  return receiver.flux_map->flux_map(sums).incident.power_W.value;
}

// Plausibility test of the light with a few rays: one error for each source inside a closed part,
// for each source whose light misses the scene, and for each flux map without light at the
// experiment's attitude. Empty for scenes with too many lamps for a quick test.
std::vector<InputError> unlit_receiver_errors(const OpticalRun& run) {
  constexpr size_t max_lamps = 256;
  constexpr double rounding = 1e-9;
  const Experiment& experiment = run.experiment();
  if (experiment.beams.size() > max_lamps) return {};
  const FewRays few(experiment);
  std::vector<InputError> mistakes;
  std::vector<double> on_receiver_W(experiment.receivers.size(), 0.0);
  for (const Settings& source : experiment.file.sources) {
    const std::vector<Beam> beams = beams_of(experiment, source);
    if (beams.empty()) continue;  // another source has the same name
    const TraceResult result =
        trace(run.scene(), experiment.lab_from_body, beams, few.receivers, few.options);
    const std::string part = inside_of(experiment, few.inside, result.sums.back(), result.sent_W);
    if (!part.empty() && is_turned_inwards(experiment.scene, part)) {
      mistakes.push_back({source.where(), "scene.file",
                          "\"" + part + "\", whose faces point inwards: light falls on their backs",
                          "faces that look outwards (turn them where the model was made)"});
    } else if (!part.empty() && has_place(beams)) {
      mistakes.push_back(
          source.error("position_m", "a place inside of \"" + part + "\"", "one outside of it"));
    } else if (has_place(beams) &&                // a sun may light the edges of sheets alone
               result.segments == result.rays &&  // a white scene lets all of its light escape, too
               result.power_balance.escaped_W.value >=
                   (1.0 - rounding) * result.power_balance.emitted_W) {
      mistakes.push_back(source.error("direction", "light that misses the scene", "light on it"));
    }
    for (size_t i = 0; i < experiment.receivers.size(); ++i) {
      if (!experiment.receivers[i].flux_map) continue;
      on_receiver_W[i] += lit_W(experiment.receivers[i], result.sums[i]);
    }
  }
  if (!mistakes.empty()) return mistakes;  // These mistakes explain dark maps.
  for (size_t i = 0; i < experiment.file.receivers.size(); ++i) {
    const NamedReceiver& receiver = experiment.receivers[i];
    if (!receiver.flux_map || on_receiver_W[i] > 0.0) continue;
    mistakes.push_back(experiment.file.receivers[i].error(
        "node", "\"" + receiver.name + "\", which no light reaches",
        "a lit part; check `node`, `side` and `facing`"));
  }
  return mistakes;
}

// Collects the mistakes, table by table; of each table the first.
class Checker {
 public:
  enum class Of { file, design_of_sweep };
  Checker(const RunOptions& options, KeyCheck keys, Of of = Of::file)
      : options_(options), by_declaration_(keys == KeyCheck::by_declaration), of_(of) {}

  CheckReport report() {
    if (by_declaration_) {
      attempt([&] {
        report_.mistakes = misread_keys(options_.settings(options_.all_overrides()), tables_);
        // The numbers of an array share one line.
        const auto line = [](const InputError& mistake) { return std::string(mistake.what()); };
        const auto again = std::ranges::unique(report_.mistakes, {}, line);
        report_.mistakes.erase(again.begin(), again.end());
      });
      for (const InputError& mistake : report_.mistakes) misread_.push_back(table_of(mistake));
    }
    attempt([&] {
      file_ = read_experiment_text(options_.experiment, options_.experiment_text(),
                                   options_.all_overrides());
    });
    if (file_) note_tables();
    if (file_) read_tables();
    return std::move(report_);
  }

 private:
  void note_tables() {
    for (const Key& table : tables_) {
      if (file_->settings.has(table.name)) report_.tables.push_back(table.name);
    }
  }

  void read_tables() {
    const bool fits = file_->settings.has("fit");
    // A scene without lamps together with a platform is used only by the camera.
    const bool unlit = file_->sources.empty() && file_->settings.has("platform");
    const bool is_module = file_->settings.has("module");
    if (file_->scene_file && !unlit) check_light();
    if (file_->settings.has("platform")) check_motion();
    if (fits) attempt([&] { add("fit-cell", describe_fit(options_)); });
    if (is_module) check_module();
    if (file_->settings.has("sweep") && of_ == Of::file) check_sweep();
    if (!file_->scene_file && !file_->settings.has("platform") && !fits && !is_module) {
      add_mistake(file_->settings.error("", "no table that a command requires",
                                        "[scene], [platform], [module] or [fit]"));
    }
  }

  // Runs `work`. Returns whether it succeeded; otherwise adds its error once.
  bool attempt(const std::function<void()>& work) {
    try {
      work();
      return true;
    } catch (const InputError& error) {
      const std::string what = error.what();
      const bool whole = error.names_file() || what.starts_with("--");
      add_mistake(whole ? error : InputError({options_.experiment.string()}, what, "", ""));
      return false;
    }
  }
  void add_mistake(const InputError& mistake) {
    const std::string line = mistake.what();
    const bool known = std::ranges::any_of(
        report_.mistakes, [&](const InputError& other) { return other.what() == line; });
    // An error that follows from a misspelt key is not reported separately.
    const bool follows = std::ranges::find(misread_, table_of(mistake)) != misread_.end();
    if (!known && !follows) report_.mistakes.push_back(mistake);
  }
  void add(const std::string& command, const std::string& what) {
    report_.commands.push_back({command, what});
  }

  void check_light() {
    std::shared_ptr<OpticalRun> run;
    if (!attempt([&] { run = std::make_shared<OpticalRun>(options_, Console()); })) return;
    report_.notes = run->experiment().notices;
    for (const std::string& doubt : run->experiment().warnings) report_.notes.push_back(doubt);
    attempt([&] { read_published(file_->others("published")); });
    for (const InputError& mistake : unlit_receiver_errors(*run)) add_mistake(mistake);
    check_light_settings(*run);
    if (file_->settings.has("array")) attempt([&] { check_array(*run); });
    check_recordings_of_light(*run);
  }

  // Whether an experiment is meant for recordings of light: it states instruments of light, or
  // missing effects.
  void check_recordings_of_light(const OpticalRun& run) {
    const auto are_of_light = [](const Settings& sensors) {
      return sensors.has("irradiance") || sensors.has("array");
    };
    const bool is_meant = file_->settings.has("platform")
                              ? std::ranges::any_of(file_->others("sensors"), are_of_light)
                              : file_->settings.has("sensors") || file_->settings.has("effect");
    if (!is_meant) return;
    attempt([&] {
      const LightLab lab(run.experiment());
      add("diagnose", "scans, sweeps and runs (--recording FILE) of " +
                          counted(lab.lamps(), "lamp") + " on " + lab.receiver());
    });
  }

  void check_light_settings(const OpticalRun& run) {
    const Experiment& experiment = run.experiment();
    double power_W = 0.0;
    for (const Beam& beam : experiment.beams) power_W += beam.emitter->power_W();
    std::string onto;
    for (size_t i = 0; i < experiment.file.receivers.size(); ++i) {
      const NamedReceiver& receiver = experiment.receivers[i];
      onto += (onto.empty() ? "" : ", ") + receiver.name + " (" + receiver.kind + ")";
    }
    if (!experiment.flow) {
      add("trace", std::to_string(experiment.file.trace.rays) + " rays of " +
                       counted(experiment.beams.size(), "lamp") + ", " + show(power_W) + " W, " +
                       (onto.empty() ? "without receivers" : "onto " + onto));
      add("render", std::to_string(experiment.camera.width) + " × " +
                        std::to_string(experiment.camera.height) + " pixels");
    }
    const AttitudeGrid& grid = file_->torque_map;
    if (file_->light_directions) {
      add("torque-map", counted(file_->light_directions->elevation_rad.size(), "elevation") +
                            " × " +
                            counted(file_->light_directions->azimuth_rad.size(), "azimuth"));
    } else {
      add("torque-map", counted(grid.tilt_rad.size(), "tilt") + " × " +
                            counted(grid.heading_rad.size(), "heading"));
    }
  }

  void check_array(OpticalRun& run) {
    const ArrayPower array = read_array_power(run);
    for (const std::string& notice : array.notices) report_.notes.push_back(notice);
    // Evaluate the array without light, to check that the cells lie on the map.
    const FluxMapReceiver& map = run.flux_map(array.flux_map);
    const BinSums dark{map.bins(), 2, std::vector<double>(2 * map.bins(), 0.0)};
    BinSums dark_angles;
    if (array.incidence) {
      const size_t bins = run.experiment().receivers[*array.incidence].receiver->bins();
      dark_angles = {bins, 2, std::vector<double>(2 * bins, 0.0)};
    }
    cell_currents(array.design, array_light(map, dark, dark_angles), array.responsivity_A_W);
    add("power", counted(static_cast<size_t>(array.design.cells()), "cell") + " on " + map.name());
  }

  void check_motion() {
    std::unique_ptr<AttitudeExperiment> experiment;
    if (!attempt([&] { experiment = std::make_unique<AttitudeExperiment>(options_); })) return;
    const Settings& settings = experiment->settings();
    if (!attempt([&] { read_attitude_model(settings); })) return;
    attempt([&] { report_propagation(read_propagation(settings)); });
    attempt([&] {
      const ServeSettings serve = read_serve(settings);
      add("serve", show(serve.rate_Hz) + " Hz at " + serve.address);
    });
    add("fmu", "a unit for co-simulation by FMI 3.0 or 2.0");
    if (settings.has("supply_trade")) {
      attempt([&] { add("supply", supply_in_words(options_)); });
    }
    attempt([&] {
      const EstimateStudy study = read_estimate(settings);
      add("estimate", "recordings of motion (--recording FILE), or simulated runs: " +
                          std::to_string(study.runs));
      const auto& camera = study.nominal.sensors.camera;
      if (!camera || !camera->geometry) return;
      const Platform& platform = study.nominal.model.platform;
      read_camera_study(settings, *camera->geometry, platform.tilt_limit_rad);
      add("camera", counted(camera->geometry->markers.size(), "marker"));
    });
    attempt([&] {
      const Budget budget = read_budget(settings);
      add("budget", counted(budget.entries.size(), "torque"));
    });
    attempt([&] {
      if (!settings.has("balance")) return;
      const Settings balance = own_table(settings, "balance", false);
      const auto masses = read_moving_masses(balance);
      balance.finish();
      add("balance",
          "a recording (--recording FILE); moving masses: " + std::to_string(masses.size()));
    });
    attempt([&] {
      const Settings recording = own_table(settings, "recording", false);
      read_recording_options(recording);
      recording.finish();
      add("diagnose", "recordings of motion (--recording FILE)");
    });
  }

  void report_propagation(const PropagationRun& run) {
    std::string light;
    if (has_light(*file_)) {
      const LightSettings settings = read_light(*file_);
      require_light_once(*file_);
      if (settings.mode == LightSettings::Mode::table) light = ", with a table of light";
      if (settings.mode == LightSettings::Mode::trace) light = ", with light traced during the run";
    }
    add("propagate", show(run.duration_s) + " s of " + show(run.model.platform.mass_kg) +
                         " kg under " + counted(run.model.disturbances.size(), "disturbance") +
                         light);
  }

  void check_module() {
    attempt([&] {
      const ModuleDesign design = read_module(file_->settings, options_.experiment.parent_path());
      add("diagnose", "curves (--recording FILE) of a module of " +
                          counted(static_cast<size_t>(design.cells), "cell") +
                          " in series, beside " +
                          (design.datasheet.empty()
                               ? counted(design.references.size(), "reference curve")
                               : counted(design.datasheet.size(), "point") + " of its datasheet"));
    });
  }

  void check_sweep() {
    attempt([&] {
      const SweepPlan plan = read_sweep_plan(file_->others("sweep").front());
      const std::string lacks = missing_search_keys(plan);
      const bool can_run = check_designs(plan);
      const std::string over = counted(plan.designs(), "design") + " by " + plan.verb;
      std::string no_search, no_sweep;
      if (!lacks.empty()) no_search = "[sweep] lacks " + lacks;
      if (plan.designs() == 0) {
        no_sweep = "an axis of [sweep] with from and to has neither count nor values";
      }
      if (!can_run) no_search = no_sweep = plan.verb + " cannot run with its designs";
      report_command("optimise", "over " + counted(plan.axes.size(), "key") + " by " + plan.verb,
                     no_search);
      report_command("sweep", over, no_sweep);
    });
  }

  void report_command(const std::string& command, const std::string& what,
                      const std::string& why_not) {
    if (why_not.empty()) {
      add(command, what);
    } else {
      report_.impossible.push_back({command, why_not});
    }
  }

  // Whether the verb of a sweep can run with the keys of its first and last design.
  bool check_designs(const SweepPlan& plan) {
    const KeyCheck keys = by_declaration_ ? KeyCheck::by_declaration : KeyCheck::by_readers;
    std::set<size_t> designs = {0};
    if (plan.designs() > 0) designs.insert(plan.designs() - 1);
    for (const size_t design : designs) {
      RunOptions options = options_;
      if (plan.designs() > 0) {
        for (const std::string& one : plan.overrides(design)) options.overrides.push_back(one);
      }
      const CheckReport report = Checker(options, keys, Of::design_of_sweep).report();
      for (const InputError& mistake : report.mistakes) add_mistake(of_sweep(mistake));
      const auto is_its_verb = [&](const auto& command) { return command.name == plan.verb; };
      if (std::ranges::none_of(report.commands, is_its_verb)) return false;
    }
    return true;
  }
  // Keys of a design are changed as by --set; such errors are reported as errors of the sweep.
  InputError of_sweep(const InputError& mistake) const {
    const std::string what = mistake.what(), set = "--set: ";
    if (!what.starts_with(set) || !options_.overrides.empty()) return mistake;
    return InputError({options_.experiment.string()}, "sweep: " + what.substr(set.size()), "", "");
  }

  const RunOptions& options_;
  bool by_declaration_;
  Of of_;
  std::vector<Key> tables_ = experiment_keys();
  std::vector<std::string> misread_;  // tables with wrong keys
  std::optional<ExperimentFile> file_;
  CheckReport report_;
};

}  // namespace

CheckReport run_check(const RunOptions& options, KeyCheck keys) {
  return Checker(options, keys).report();
}

void print_json(const CheckReport& report) {
  using Json = nlohmann::ordered_json;
  const auto listed = [](const std::vector<CheckReport::Command>& commands) {
    Json list = Json::array();
    for (const CheckReport::Command& one : commands) {
      list.push_back({{"name", one.name}, {"what", clean_text(one.what)}});
    }
    return list;
  };
  Json json = {{"schema", "photorque.check/1"},
               {"commands", listed(report.commands)},
               {"impossible", listed(report.impossible)},
               {"tables", report.tables},
               {"mistakes", Json::array()},
               {"notes", Json::array()}};
  for (const InputError& mistake : report.mistakes) {
    json["mistakes"].push_back(clean_text(mistake.what()));
  }
  for (const std::string& note : report.notes) json["notes"].push_back(clean_text(note));
  std::puts(json.dump(2).c_str());
}

}  // namespace photorque

namespace photorque::verbs::check {
namespace {

void add_options(Command& command, CommandOptions& options) {
  command.add_experiment(options, Command::Folder::none);
}

void print_commands(const Console& console, const CheckReport& report,
                    const std::vector<Verb>& verbs) {
  for (const CheckReport::Command& command : report.commands) {
    const Verb& verb = *std::ranges::find(verbs, command.name, &Verb::name);
    std::string tables;
    for (const std::string& table : report.tables) {
      if (std::ranges::find(verb.tables, table) != verb.tables.end()) tables += " [" + table + "]";
    }
    console.line(padded(command.name, 12) + command.what);
    console.line(padded("", 12) + "reads" + tables);
  }
}

// Prints the required tables of each command for which the file has none.
void print_lacking(const Console& console, const CheckReport& report,
                   const std::vector<Verb>& verbs) {
  std::vector<std::string> printed_needs;
  for (const Verb& verb : verbs) {
    if (verb.needs.empty() || std::ranges::find(printed_needs, verb.needs) != printed_needs.end())
      continue;
    printed_needs.push_back(verb.needs);
    std::string names;
    bool runs = false;
    for (const Verb& other : verbs) {
      if (other.needs != verb.needs) continue;
      names += (names.empty() ? "" : ", ") + other.name;
      runs = runs || std::ranges::find(report.commands, other.name, &CheckReport::Command::name) !=
                         report.commands.end();
    }
    // Not printed for `optimise` if `sweep` can run, and vice versa: both read [sweep].
    if (!runs) console.line("not " + names + ": without " + verb.needs);
  }
}

void run(const CommandOptions& options, const Program& program) {
  const Console console = terminal(options);
  const CheckReport report = run_check(options);
  if (options.json) print_json(report);
  print_commands(console, report, program.verbs);
  if (report.mistakes.empty()) print_lacking(console, report, program.verbs);
  for (const CheckReport::Command& command : report.impossible) {
    console.line("not " + command.name + ": " + command.what);
  }
  for (const std::string& note : report.notes) console.line("note: " + note);
  if (report.mistakes.empty()) return;
  constexpr size_t most = 50;
  const size_t others = report.mistakes.size() - 1;
  for (size_t i = 0; i < std::min(others, most); ++i) {
    std::fprintf(stderr, "%s\n", clean_text(report.mistakes[i].what()).c_str());
  }
  if (others > most)
    std::fprintf(stderr, "and %zu more mistakes, of which the last:\n", others - most);
  throw InputError(report.mistakes.back());
}

}  // namespace

Verb kind() {
  return {"check", "Errors of an experiment, and the commands that can use it",
          command_with(add_options, run)};
}

}  // namespace photorque::verbs::check
