#include "tools/tasks/fit_cell.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "photovoltaics/fit/fit.h"
#include "scenes/experiment/toml.h"
#include "tools/cells/words.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

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

RunResult fit_cell_of_experiment(const RunOptions& options, const Console& console) {
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
