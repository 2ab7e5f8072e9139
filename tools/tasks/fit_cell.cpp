#include "tools/tasks/fit_cell.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text/columns.h"
#include "diagnosis/light/recordings/recording.h"
#include "photovoltaics/fit/fit.h"
#include "scenes/experiment/toml_reader.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// What [fit] says.
struct FitTask {
  std::vector<fs::path> files;
  std::vector<IvSweep> sweeps;
  std::vector<RatedPoint> datasheet;
  TemperatureSlopes slopes;
  RatedTolerance tolerance;
  SweepNoise noise;
  int cells_in_series = 1;
  int substrings = 0;  // 0: even light
  double temperature_K = 298.15;
};

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

RatedPoint read_point(const Settings& s) {
  return {s.number_or("irradiance_W_m2", 1000.0, Range::positive()),
          s.number_or("temperature_K", 298.15, {1.0, 1000.0}),
          s.number("short_circuit_A", Range::positive()),
          s.number("open_circuit_V", Range::positive()),
          s.number("maximum_A", Range::positive()),
          s.number("maximum_V", Range::positive())};
}

FitTask read_task(const Settings& root, const fs::path& folder) {
  const Settings s = root.table("fit");
  FitTask task;
  task.cells_in_series = static_cast<int>(s.integer_or("cells_in_series", 1, 1, 2000));
  task.temperature_K = s.number_or("temperature_K", 298.15, {1.0, 1000.0});
  if (s.has("curves") == s.has("datasheet")) {
    throw s.error("curves", s.has("curves") ? "curves and a datasheet" : "neither",
                  "either curves = [\"sweep.csv\"] or [[fit.datasheet]]");
  }
  if (s.has("datasheet")) {
    if (s.has("temperature_K")) {
      throw s.error("temperature_K", "a temperature beside a datasheet",
                    "temperature_K in [[fit.datasheet]]");
    }
    for (const Settings& point : s.tables("datasheet")) task.datasheet.push_back(read_point(point));
    task.slopes.short_circuit_1_K = s.number_or("short_circuit_slope_per_K", 5e-4);
    task.slopes.open_circuit_1_K = s.number_or("open_circuit_slope_per_K", -3e-3);
    const RatedTolerance written = written_steps(task.datasheet);
    task.tolerance = {s.number_or("rounding_A", written.step_A, Range::not_negative()),
                      s.number_or("rounding_V", written.step_V, Range::not_negative()),
                      s.number_or("tolerance", 0.0, {0.0, 0.5})};
  } else {
    for (const std::string& name : s.texts("curves")) {
      task.files.push_back(folder / name);
      task.sweeps.push_back(read_sweep(task.files.back()));
    }
    task.noise.current_fraction = s.number_or("current_noise", 1e-3, Range::positive());
    task.noise.voltage_fraction = s.number_or("voltage_noise", 5e-4, Range::positive());
    task.noise.correlation_points = s.number_or("correlation_points", 0.0, Range::not_negative());
    task.substrings = static_cast<int>(s.integer_or("substrings", 0, 0, 100));
    if (task.substrings > 0 && task.cells_in_series > 1 &&
        task.cells_in_series % task.substrings != 0) {
      throw s.error("cells_in_series", std::to_string(task.cells_in_series),
                    "a multiple of substrings, " + std::to_string(task.substrings));
    }
    if (task.substrings > 0 && s.has("correlation_points")) {
      throw s.error("correlation_points", "a correlation for a partly shaded string",
                    "none: there every point has an error of its own");
    }
    if (s.flag_or("even_voltage_steps", false)) {
      const EvenSweeps even = with_even_steps(task.sweeps, task.noise);
      task.sweeps = even.sweeps;
      task.noise = even.noise;
    }
  }
  root.finish();
  return task;
}

struct Row {
  std::string name;
  Estimate estimate;
};

Product parameter_product(const std::vector<Row>& rows) {
  Product product;
  Table table =
      Table::of("parameters", "Fitted parameters", {"parameter", "value", "standard_error"});
  for (const Row& row : rows) {
    product.quantities.push_back({row.name, row.estimate});
    table.row()
        .set("parameter", row.name)
        .set("value", row.estimate.value)
        .set("standard_error", row.estimate.standard_error);
  }
  product.tables.push_back(table);
  return product;
}

void print_rows(const Console& console, const std::vector<Row>& rows) {
  console.heading("Fitted parameters (± standard error)");
  for (const Row& row : rows) {
    // Beyond every leak that a curve could show there is no number.
    const bool is_open = row.name == "shunt_ohm" && !(row.estimate.value < 1e12);
    console.line("  " + row.name +
                 std::string(row.name.size() < 26 ? 26 - row.name.size() : 1, ' ') +
                 (is_open ? std::string("none: these data show no leak") : show(row.estimate, "")));
  }
}

double ideality_per_scale(const FitTask& task) {
  const double thermal_V = boltzmann_J_K * task.temperature_K / elementary_charge_C;
  return 1.0 / (task.cells_in_series * thermal_V);
}

// What no junction of silicon or any other material is: 0.5 is sharper than its thermal voltage
// allows, 4 is a leak.
void check_ideality(const SingleDiode& d, const FitTask& task) {
  const double ideality = d.scale_V.value * ideality_per_scale(task);
  constexpr double lowest = 0.5, highest = 4.0;
  if (ideality >= lowest && ideality <= highest) return;
  throw InputError({}, "fit.cells_in_series",
                   std::to_string(task.cells_in_series) +
                       " cells, which makes the ideality of one " + show(ideality),
                   "the number of cells in series of this device (an ideality of 1 to 2)");
}

void print_ideality_note(const Console& console, const SingleDiode& d, const FitTask& task) {
  const double ideality = d.scale_V.value * ideality_per_scale(task);
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

std::vector<Row> diode_rows(const SingleDiode& d, const FitTask& task) {
  const double per_cell = ideality_per_scale(task);
  return {{"photocurrent_A", d.photocurrent_A},
          {"saturation_A", d.saturation_A},
          {"ideality", {d.scale_V.value * per_cell, d.scale_V.standard_error * per_cell}},
          {"series_ohm", d.series_ohm},
          {"shunt_ohm", d.shunt_ohm}};
}

// A number that is positive by its nature, and known to better than itself.
bool is_determined(const Estimate& e) {
  return e.standard_error < e.value;
}

// Parameters that are positive by their nature and come out with an error as large as themselves,
// which may be infinite.
void print_undetermined(const Console& console, const std::vector<Row>& rows) {
  std::string names;
  for (const Row& row : rows) {
    const Estimate& e = row.estimate;
    if (is_determined(e)) continue;
    names += (names.empty() ? "" : ", ") + row.name;
  }
  if (!names.empty()) console.line("  these data do not determine " + names);
}

void print_key(const Console& console, const char* name, double value) {
  char text[80];
  std::snprintf(text, sizeof text, "  %s = %.9g", name, value);
  console.line(text);
}

// The keys of an experiment's [array.cell_parameters] for one of the cells.
void print_cell(const Console& console, const SingleDiode& d, const FitTask& task, int cells) {
  const double thermal_V = boltzmann_J_K * task.temperature_K / elementary_charge_C;
  console.heading("One cell, for [array.cell_parameters]");
  const auto key = [&](const char* name, double value) { print_key(console, name, value); };
  key("saturation_1_A", d.saturation_A.value);
  key("ideality_1", d.scale_V.value / (cells * thermal_V));
  key("series_ohm", d.series_ohm.value / cells);
  key("shunt_ohm", d.shunt_ohm.value / cells);
  key("reference_temperature_K", task.temperature_K);
  console.line("  reference_area_m2 =   # to be filled in: the area of one cell");
}

// Measured points and a fitted curve, as current and as power.
void add_plots(const FitTask& task, const std::vector<ArrayPoint>& fitted,
               const std::vector<ArrayPoint>& maxima, Product& product) {
  Plot plot{"fit", "Measured and fitted", "voltage [V]", "current [A]", {}, false, false, {}};
  Plot::Panel power{"power [W]", {}, false};
  Plot::Curve measured{"measured", {}, {}, {}, true}, line{"fitted", {}, {}, {}, false};
  for (const IvSweep& sweep : task.sweeps) {
    measured.x.insert(measured.x.end(), sweep.voltage_V.begin(), sweep.voltage_V.end());
    measured.y.insert(measured.y.end(), sweep.current_A.begin(), sweep.current_A.end());
  }
  for (const RatedPoint& p : task.datasheet) {
    for (const auto& [v, i] :
         {std::pair{0.0, p.short_circuit_A}, {p.maximum_V, p.maximum_A}, {p.open_circuit_V, 0.0}}) {
      measured.x.push_back(v);
      measured.y.push_back(i);
    }
  }
  for (const ArrayPoint& p : fitted) {
    line.x.push_back(p.voltage_V);
    line.y.push_back(p.current_A);
  }
  const auto times_voltage = [](Plot::Curve curve) {
    for (size_t i = 0; i < curve.x.size(); ++i) curve.y[i] *= curve.x[i];
    return curve;
  };
  Plot::Curve peaks{"maxima", {}, {}, {}, true};
  for (const ArrayPoint& p : maxima) {
    peaks.x.push_back(p.voltage_V);
    peaks.y.push_back(p.power_W());
  }
  power.curves = {times_voltage(measured), times_voltage(line), peaks};
  plot.curves = {measured, line};
  plot.below.push_back(power);
  product.plots.push_back(plot);
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
  std::vector<Row> rows = diode_rows(fit.diode, task);
  const CellCurve cell(fit.diode.parameters(task.temperature_K));
  const ArrayPoint best = best_point(cell, fit.diode.photocurrent_A.value);
  print_rows(console, rows);
  print_undetermined(console, rows);
  print_ideality_note(console, fit.diode, task);
  console.line("  rms of current " + show(fit.rms_A) + " A over " + std::to_string(fit.points) +
               " points; scatter over that expected " + show(std::sqrt(fit.variance)));
  print_misfit(console, std::sqrt(fit.variance));
  console.line("  maximum " + show(best.power_W()) + " W at " + show(best.voltage_V) + " V");
  print_cell(console, fit.diode, task, task.cells_in_series);
  rows.push_back({"rms_current_A", {fit.rms_A, 0.0}});
  rows.push_back({"maximum_power_W", {best.power_W(), 0.0}});
  Product product = parameter_product(rows);
  add_plots(task, cell_points(cell, fit.diode.photocurrent_A.value), {best}, product);
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
  std::vector<Row> rows = diode_rows(fit.diode, at_first);
  rows.push_back({"gap_eV", {fit.model.gap_eV, fit.gap_error_eV}});
  rows.push_back({"rms_fraction", {fit.rms, 0.0}});
  print_rows(console, rows);
  const RatedTolerance& t = task.tolerance;
  console.line(
      "  errors: of figures rounded to " + show(t.step_A) + " A and " + show(t.step_V) + " V" +
      (t.fraction > 0.0 ? ", each good to " + show_percent(t.fraction) + " (one sigma)" : "") +
      (task.datasheet.size() == 1 ? "; one point leaves the ideality as assumed" : ""));
  print_cell(console, fit.diode, at_first, task.cells_in_series);
  print_key(console, "gap_eV", fit.model.gap_eV);
  print_key(console, "gap_slope_per_K", fit.model.gap_slope_1_K);
  print_key(console, "photocurrent_slope_per_K", fit.model.photocurrent_slope_1_K);
  const CellCurve cell(fit.model.reference);
  Product product = parameter_product(rows);
  add_plots(task, cell_points(cell, fit.diode.photocurrent_A.value),
            {best_point(cell, fit.diode.photocurrent_A.value)}, product);
  return product;
}

Product fit_uneven_light(const FitTask& task, const Console& console) {
  if (task.sweeps.size() != 1) {
    throw InputError({}, "fit.curves", std::to_string(task.sweeps.size()) + " curves",
                     "one curve of a partly shaded string");
  }
  const ShadedFit fit = fit_shaded_string(task.sweeps[0], task.substrings, task.noise);
  std::vector<Row> rows;
  for (size_t k = 0; k < fit.photocurrents_A.size(); ++k) {
    rows.push_back({"photocurrent_" + std::to_string(k + 1) + "_A", fit.photocurrents_A[k]});
  }
  FitTask substring = task;
  substring.cells_in_series = std::max(1, task.cells_in_series / task.substrings);
  const std::vector<Row> shared = diode_rows(fit.substring, substring);
  rows.insert(rows.end(), shared.begin() + 1, shared.end());
  rows.push_back({"bypass_drop_V", fit.bypass_drop_V});
  print_rows(console, rows);
  print_undetermined(console, shared);
  console.line("  rms of current " + show(fit.rms_A) + " A");
  const ArrayCurve::Scan scan = fit.curve(task.temperature_K).scan(400);
  console.heading("Local maxima of the power");
  for (const ArrayPoint& p : scan.maxima) {
    console.line("  " + show(p.power_W()) + " W at " + show(p.voltage_V) + " V");
  }
  rows.push_back({"rms_current_A", {fit.rms_A, 0.0}});
  Product product = parameter_product(rows);
  add_plots(task, scan.points, scan.maxima, product);
  return product;
}

FitTask task_of(const RunOptions& options, const std::string& text) {
  SettingsNode root = parse_toml(text, options.experiment.string());
  for (const std::string& assignment : options.overrides) apply_override(root, assignment);
  return read_task(Settings(std::make_shared<const SettingsNode>(std::move(root))),
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
