// photorque fit-cell: the parameters of a solar cell, module or shaded string from measurements.
#include "tools/verbs/fit_cell.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "diagnosis/light/model/recording.h"
#include "photovoltaics/fit/fit.h"
#include "photovoltaics/fit/rated_keys.h"
#include "scenes/experiment/toml.h"
#include "tools/keys/fit.h"
#include "tools/verbs/fitted_cell.h"
#include "tools/verbs/verb.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// voltage_V,current_A; or V,I as some instruments write.
IvSweep read_sweep(const fs::path& file) {
  if (file.extension() == ".gz") {
    const LightRecording recording = read_light_recording(file, {});
    if (recording.kind != LightRecording::Kind::sweep) {
      throw InputError({file.string()}, "header", "another recording of light",
                       "a curve with voltage_V,current_A");
    }
    return {recording.voltage_V, recording.current_A};
  }
  const std::vector<std::string> header = read_column_names(file);
  const auto named = [&](const std::string& name, const std::string& other) {
    const bool has_other = std::ranges::find(header, name) == header.end() &&
                           std::ranges::find(header, other) != header.end();
    return has_other ? other : name;
  };
  const NumberColumns numbers =
      read_number_columns(file, {named("voltage_V", "V"), named("current_A", "I")});
  return {numbers.columns[0], numbers.columns[1]};
}

// The open-circuit voltage of one cell: 0.3 V in moonlight, 4.5 V of the best stacks of junctions.
void check_cells(const Settings& s, const FitTask& task) {
  if (task.substrings > 0 && task.cells_in_series == 1) return;  // not stated
  double open_V = 0.0;
  for (const RatedPoint& p : task.datasheet) open_V = std::max(open_V, p.open_circuit_V);
  for (const IvSweep& sweep : task.sweeps) {
    for (size_t i = 0; i < std::min(sweep.voltage_V.size(), sweep.current_A.size()); ++i) {
      if (sweep.current_A[i] >= 0.0) open_V = std::max(open_V, sweep.voltage_V[i]);
    }
  }
  constexpr double lowest_V = 0.1, highest_V = 5.0;
  const double one_V = open_V / task.cells_in_series;
  if (open_V == 0.0 || (one_V >= lowest_V && one_V <= highest_V)) return;
  throw s.error(fit_key::cells_in_series,
                std::to_string(task.cells_in_series) + " cells, of " + readable_number(one_V, 3) +
                    " V each at open circuit",
                "cells that give 0.1 to 5 V each of these " + readable_number(open_V, 3) + " V");
}

// Reads the curves too, relative to `folder`. InputError for what is missing or contradicts itself,
// and for cells in series that no cell's voltage goes with.
FitTask read_fit_task(const Settings& root, const fs::path& folder) {
  const Settings s = root.get(fit_key::fit);
  FitTask task;
  task.cells_in_series = static_cast<int>(s.get(fit_key::cells_in_series));
  task.temperature_K = s.get(fit_key::temperature);
  if (s.has(fit_key::curves) == s.has(fit_key::datasheet)) {
    throw s.error(fit_key::curves, s.has(fit_key::curves) ? "curves and a datasheet" : "neither",
                  "either curves = [\"sweep.csv\"] or [[fit.datasheet]]");
  }
  if (s.has(fit_key::datasheet)) {
    if (s.has(fit_key::temperature)) {
      throw s.error(fit_key::temperature, "a temperature beside a datasheet",
                    "temperature_K in [[fit.datasheet]]");
    }
    for (const Settings& point : s.get(fit_key::datasheet))
      task.datasheet.push_back(read_rated_point(point));
    task.slopes = read_rated_slopes(s);
    const RatedTolerance written = written_steps(task.datasheet);
    task.tolerance = {s.get_or(fit_key::rounding_current, written.step_A),
                      s.get_or(fit_key::rounding_voltage, written.step_V),
                      s.get(fit_key::tolerance)};
  } else {
    for (const std::string& name : s.get(fit_key::curves)) {
      task.files.push_back(folder / name);
      task.sweeps.push_back(read_sweep(task.files.back()));
    }
    task.noise.current_fraction = s.get(fit_key::current_noise);
    task.noise.voltage_fraction = s.get(fit_key::voltage_noise);
    task.noise.correlation_points = s.get(fit_key::correlation_points);
    task.substrings = static_cast<int>(s.get(fit_key::substrings));
    if (task.substrings > 0 && task.cells_in_series > 1 &&
        task.cells_in_series % task.substrings != 0) {
      throw s.error(fit_key::cells_in_series, std::to_string(task.cells_in_series),
                    "a multiple of substrings, " + std::to_string(task.substrings));
    }
    if (task.substrings > 0 && s.has(fit_key::correlation_points)) {
      throw s.error(fit_key::correlation_points, "a correlation for a partly shaded string",
                    "none: there every point has an error of its own");
    }
    if (s.get(fit_key::even_voltage_steps)) {
      const EvenSweeps even = with_even_steps(task.sweeps, task.noise);
      task.sweeps = even.sweeps;
      task.noise = even.noise;
    }
  }
  root.finish();
  check_cells(s, task);
  return task;
}

// What no junction of silicon or any other material is: 0.5 is sharper than its thermal voltage
// allows, 4 is a leak.
void check_ideality(const SingleDiode& d, const FitTask& task) {
  const double ideality = d.scale_V.value / task.thermal_V();
  constexpr double lowest = 0.5, highest = 4.0;
  if (ideality >= lowest && ideality <= highest) return;
  throw InputError({}, "fit.cells_in_series",
                   std::to_string(task.cells_in_series) +
                       " cells, which makes the ideality of one " + show(ideality),
                   "the number of cells in series of this device (an ideality of 1 to 2)");
}

void print_ideality_note(const Console& console, const SingleDiode& d, const FitTask& task) {
  const double ideality = d.scale_V.value / task.thermal_V();
  if (ideality >= 0.9 && ideality <= 3.0) return;
  console.line("  note: an ideality of " + show(ideality) + " is unusual: are cells_in_series (" +
               std::to_string(task.cells_in_series) + ") and the temperature right?");
}

// A diode that is off by a good part of the current describes nothing.
void check_rms(double rms_A, const FitTask& task) {
  double largest_A = 0.0;
  for (const IvSweep& sweep : task.sweeps) {
    largest_A = std::max(largest_A, *std::ranges::max_element(sweep.current_A));
  }
  constexpr double of_current = 0.1;
  if (rms_A < of_current * largest_A) return;
  throw InputError({}, "fit.curves",
                   "a curve that no diode comes nearer than " + show(rms_A) + " A (rms)",
                   "a sweep of one lit device in even light, currents positive; for uneven light "
                   "substrings = N");
}

// The errors rest on the scatter, so they are as wide as the misfit is; but parameters of a model
// that does not describe the data are off by more than chance.
void print_misfit(const Console& console, double scatter) {
  constexpr double usual = 3.0;
  if (scatter < usual) return;
  console.line("  warning: the scatter is " + show(scatter) +
               " times what the noise makes: one diode does not describe these data. The errors "
               "are widened to the scatter; `photorque diagnose` with [module] says what is wrong");
}

std::vector<ArrayPoint> cell_points(const CellCurve& cell, double light_A) {
  constexpr int steps = 200;
  std::vector<ArrayPoint> points;
  const double open_V = cell.open_circuit_V(light_A);
  for (int k = 0; k <= steps; ++k) {
    const double v = open_V * k / steps;
    points.push_back({v, cell.current_A(light_A, v)});
  }
  return points;
}

ArrayPoint best_point(const CellCurve& cell, double light_A) {
  const CellOperatingPoint best = cell.maximum_power(light_A);
  return {best.voltage_V, best.current_A};
}

Product fit_even_light(const FitTask& task, const Console& console) {
  const SweepFit fit = fit_sweeps(task.sweeps, task.noise);
  check_ideality(fit.diode, task);
  check_rms(fit.rms_A, task);
  std::vector<CellRow> rows = diode_rows(fit.diode, task);
  const CellCurve cell(fit.diode.parameters(task.temperature_K));
  const ArrayPoint best = best_point(cell, fit.diode.photocurrent_A.value);
  print_rows(console, rows);
  print_undetermined(console, rows);
  print_bounds(console, fit.bounds);
  print_ideality_note(console, fit.diode, task);
  console.line("  rms of current " + show(fit.rms_A) + " A over " + std::to_string(fit.points) +
               " points; scatter over that expected " + show(std::sqrt(fit.variance)));
  print_misfit(console, std::sqrt(fit.variance));
  console.line("  maximum " + show(best.power_W()) + " W at " + show(best.voltage_V) + " V");
  print_cell(console, fit.diode, task);
  rows.push_back({"rms_current_A", {fit.rms_A, 0.0}});
  rows.push_back({"maximum_power_W", {best.power_W(), 0.0}});
  Product product = parameter_product(rows);
  add_fit_plot(task, cell_points(cell, fit.diode.photocurrent_A.value), {best}, product);
  return product;
}

Product fit_datasheet(const FitTask& task, const Console& console) {
  const double guess_V = 1.2 * task.cells_in_series * boltzmann_J_K *
                         task.datasheet[0].temperature_K / elementary_charge_C;
  const RatedFit fit = fit_rated_points(task.datasheet, task.slopes, guess_V, task.tolerance);
  FitTask at_first = task;
  at_first.temperature_K = task.datasheet[0].temperature_K;
  check_ideality(fit.diode, at_first);
  // The search for the gap ends there, whatever the slope says.
  constexpr double lowest_eV = 0.3, highest_eV = 4.0;
  if (!(fit.model.gap_eV > lowest_eV && fit.model.gap_eV < highest_eV)) {
    throw InputError({}, "fit.open_circuit_slope_per_K",
                     show(task.slopes.open_circuit_1_K) + ", which takes a gap of " +
                         show(fit.model.gap_eV) + " eV",
                     "a fraction of the open-circuit voltage per kelvin, about -0.003");
  }
  std::vector<CellRow> rows = diode_rows(fit.diode, at_first);
  rows.push_back({"gap_eV", {fit.model.gap_eV, fit.gap_error_eV}});
  rows.push_back({"rms_fraction", {fit.rms, 0.0}});
  print_rows(console, rows);
  print_bounds(console, fit.bounds);
  const RatedTolerance& t = task.tolerance;
  console.line(
      "  errors: of figures rounded to " + show(t.step_A) + " A and " + show(t.step_V) + " V" +
      (t.fraction > 0.0 ? ", each good to " + show_percent(t.fraction) + " (one sigma)" : "") +
      (task.datasheet.size() == 1 ? "; one point leaves the ideality as assumed" : ""));
  print_cell(console, fit.diode, at_first);
  print_key(console, "gap_eV", fit.model.gap_eV);
  print_key(console, "gap_slope_per_K", fit.model.gap_slope_1_K);
  print_key(console, "photocurrent_slope_per_K", fit.model.photocurrent_slope_1_K);
  const CellCurve cell(fit.model.reference);
  Product product = parameter_product(rows);
  add_fit_plot(task, cell_points(cell, fit.diode.photocurrent_A.value),
               {best_point(cell, fit.diode.photocurrent_A.value)}, product);
  return product;
}

Product fit_uneven_light(const FitTask& task, const Console& console) {
  if (task.sweeps.size() != 1) {
    throw InputError({}, "fit.curves", std::to_string(task.sweeps.size()) + " curves",
                     "one curve of a partly shaded string");
  }
  const ShadedFit fit = fit_shaded_string(task.sweeps[0], task.substrings, task.noise);
  std::vector<CellRow> rows;
  for (size_t k = 0; k < fit.photocurrents_A.size(); ++k) {
    rows.push_back({"photocurrent_" + std::to_string(k + 1) + "_A", fit.photocurrents_A[k]});
  }
  FitTask substring = task;
  substring.cells_in_series = std::max(1, task.cells_in_series / task.substrings);
  const std::vector<CellRow> shared = diode_rows(fit.substring, substring);
  rows.insert(rows.end(), shared.begin() + 1, shared.end());
  rows.push_back({"bypass_drop_V", fit.bypass_drop_V});
  print_rows(console, rows);
  print_undetermined(console, shared);
  print_bounds(console, fit.bounds);
  console.line("  rms of current " + show(fit.rms_A) + " A");
  const ArrayCurve::Scan scan = fit.curve(task.temperature_K).scan(400);
  console.heading("Local maxima of the power");
  for (const ArrayPoint& p : scan.maxima) {
    console.line("  " + show(p.power_W()) + " W at " + show(p.voltage_V) + " V");
  }
  rows.push_back({"rms_current_A", {fit.rms_A, 0.0}});
  Product product = parameter_product(rows);
  add_fit_plot(task, scan.points, scan.maxima, product);
  return product;
}

FitTask task_of(const RunOptions& options, const std::string& text) {
  SettingsNode root = parse_toml(text, options.experiment.string());
  for (const std::string& assignment : options.overrides) apply_override(root, assignment);
  return read_fit_task(Settings(std::make_shared<const SettingsNode>(std::move(root))),
                       options.experiment.parent_path());
}

}  // namespace

std::string what_fit_asks(const RunOptions& options) {
  const FitTask task = task_of(options, options.experiment_text());
  const std::string cells = std::to_string(task.cells_in_series) + " in series";
  if (!task.datasheet.empty()) {
    return std::to_string(task.datasheet.size()) + " point(s) of a datasheet, cells: " + cells;
  }
  return std::to_string(task.sweeps.size()) + " sweep(s), cells: " + cells;
}

RunResult run_fit_cell(const RunOptions& options, const Console& console) {
  const WallTime wall;
  const std::string text = options.experiment_text();
  const FitTask task = task_of(options, text);
  Provenance provenance = build_provenance();
  provenance.inputs.emplace_back(options.experiment.filename().string(), content_hash(text));
  for (const std::string& assignment : options.overrides)
    provenance.inputs.emplace_back("--set", assignment);
  for (const fs::path& file : task.files) {
    provenance.inputs.emplace_back(file.filename().string(), content_hash(read_file(file)));
  }
  Product product = !task.datasheet.empty() ? fit_datasheet(task, console)
                    : task.substrings > 0   ? fit_uneven_light(task, console)
                                            : fit_even_light(task, console);
  return {std::move(product), std::move(provenance), {wall.elapsed_s(), {}}};
}

}  // namespace photorque

namespace photorque::verbs::fit_cell {
namespace {

void add_options(Command& command, CommandOptions& options) {
  command.add_experiment(options);
}

void run(const CommandOptions& options, const Program&) {
  const Console console = terminal(options);
  write_results(options, console, run_fit_cell(options, console));
}

}  // namespace

Verb kind() {
  return {"fit-cell",
          "Solar cell parameters, with errors, from current-voltage sweeps or a datasheet",
          command_with(add_options, run),
          {"fit"},
          "[fit]",
          [](const RunOptions& options) { return run_fit_cell(options, Console()); }};
}

}  // namespace photorque::verbs::fit_cell
