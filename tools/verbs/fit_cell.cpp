// photorque fit-cell: parameters of a solar cell, module or shaded string from measurements.
#include "tools/verbs/fit_cell.h"

#include <algorithm>
#include <cmath>

#include "attitude/recordings/text_lines.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/settings/files.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "diagnosis/guess/file_head.h"
#include "photovoltaics/fit/conditions.h"
#include "photovoltaics/fit/curve_text.h"
#include "photovoltaics/fit/fit.h"
#include "photovoltaics/fit/rated_keys.h"
#include "tools/keys/fit.h"
#include "tools/verbs/fitted_cell.h"
#include "tools/verbs/verb.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// The text of a file that names its columns in numbered lines or between other separators than the
// cells of its rows: these names and the rows, as diagnose --guess reads them. Nothing for others.
std::optional<std::string> text_with_names(const fs::path& file) {
  try {
    const FileHead head = head_of(file, {});
    if (!head.is_split_otherwise) return std::nullopt;
    std::string text = whole_text(file, head.header);
    if (!curve_columns_in(text, file.string()).empty()) return text;
  } catch (const InputError&) {  // another file
  }
  return std::nullopt;
}

std::vector<MeasuredCurve> curves_of(const fs::path& file) {
  try {
    return curves_in(whole_text(file), file.string());
  } catch (const InputError&) {
    const std::optional<std::string> text = text_with_names(file);
    if (!text) throw;
    return curves_in(*text, file.string());
  }
}

// Adds the cleaned curves of a file; notes state the omitted points.
void add_curves(const fs::path& file, std::optional<double> irradiance_W_m2,
                std::optional<double> temperature_K, FitTask& task) {
  std::vector<MeasuredCurve> curves = curves_of(file);
  for (size_t k = 0; k < curves.size(); ++k) {
    MeasuredCurve& curve = curves[k];
    const std::string name =
        file.filename().string() + (curves.size() > 1 ? ", curve " + std::to_string(k + 1) : "");
    const auto note = [&](size_t count, const std::string& what) {
      if (count == 0) return;
      task.notes.push_back(name + ": left out " + std::to_string(count) + " " + what);
    };
    note(curve.unread, "rows without a reading");
    if (curve.is_stacked && k == 0) {
      task.notes.push_back(file.filename().string() +
                           ": the voltage returns in one step; read as " +
                           std::to_string(curves.size()) + " curves, one below the other");
    }
    if (curve.is_reversed) {
      task.notes.push_back(name + ": currents are negative in light; their sign was reversed");
    }
    if (curve.is_density) {
      task.is_density = true;
      task.notes.push_back(name + ": current densities; the parameters are those of 1 cm²");
    }
    if (!curve.stated.empty()) task.notes.push_back(name + ": " + curve.stated + " by its header");
    if (!curve.without_unit.empty()) {
      task.notes.push_back(name + ": " + in_quotes(curve.without_unit) +
                           " has no unit, K or °C: not used");
    }
    const CurveCleaning cleaning = clean_curve(curve.sweep, task.substrings > 0);
    note(cleaning.spikes, "readings far from both neighbours");
    note(cleaning.dead, "readings of 0 A below voltages at which a current flows");
    note(cleaning.clipped, "points from " + show(cleaning.clipped_from_V) +
                               " V on, beyond open circuit, where the meter stays at " +
                               show(cleaning.clipped_A) + " A");
    const RangeLimit limit = take_range_limit(curve.sweep);
    note(limit.readings, "readings of " + show(limit.current_A) +
                             " A, which is the end of the meter's range: the curve leaves this "
                             "plateau abruptly");
    if (curve.sweep.light.empty() && task.substrings == 0) {
      const UnsteadyLight unsteady = take_unsteady_light(curve.sweep, task.noise.current_fraction);
      note(unsteady.readings, "points between " + show(unsteady.from_V) + " and " +
                                  show(unsteady.to_V) + " V, up to " +
                                  show_percent(unsteady.largest) +
                                  " off: the light changed, since no cell's current rises with "
                                  "the voltage");
    }
    task.sweeps.push_back(curve.sweep);
    task.names.push_back(name);
    task.conditions.push_back(
        {curve.sweep, temperature_K.value_or(curve.temperature_K.value_or(task.temperature_K)),
         irradiance_W_m2.value_or(curve.irradiance_W_m2.value_or(0.0))});
  }
}

// Whether the curves are repeats, with equal light and temperature.
bool are_repeats(const std::vector<CurveAt>& curves) {
  const auto [cold, warm] = std::ranges::minmax(curves, {}, &CurveAt::temperature_K);
  const auto [dim, bright] = std::ranges::minmax(curves, {}, &CurveAt::irradiance_W_m2);
  double least_A = 1e300, most_A = 0.0;
  for (const CurveAt& curve : curves) {
    const double largest_A = std::ranges::max(curve.sweep.current_A);
    least_A = std::min(least_A, largest_A);
    most_A = std::max(most_A, largest_A);
  }
  constexpr double alike = 0.03, alike_K = 1.0;
  return most_A <= (1.0 + alike) * least_A && warm.temperature_K - cold.temperature_K <= alike_K &&
         bright.irradiance_W_m2 <= (1.0 + alike) * dim.irradiance_W_m2;
}

void read_curves(const Settings& s, const fs::path& folder, FitTask& task) {
  const std::vector<Settings> stated_curves =
      s.has(fit_key::curve) ? s.get(fit_key::curve) : std::vector<Settings>{};
  if (s.has(fit_key::curves)) {
    for (const std::string& name : s.get(fit_key::curves)) {
      const fs::path file = existing_file(s, fit_key::curves, folder, name);
      if (std::ranges::any_of(stated_curves, [&](const Settings& one) {
            return fs::equivalent(file, existing_file(one, fit_key::curve_file, folder));
          })) {
        continue;
      }
      task.files.push_back(file);
      add_curves(file, {}, {}, task);
    }
  }
  if (!stated_curves.empty()) {
    for (const Settings& one : stated_curves) {
      const auto stated = [&](const NumberKey& key) -> std::optional<double> {
        if (!one.has(key)) return std::nullopt;
        return one.get(key);
      };
      task.files.push_back(existing_file(one, fit_key::curve_file, folder));
      add_curves(task.files.back(), stated(fit_key::curve_irradiance),
                 stated(fit_key::curve_temperature), task);
    }
  }
  if (task.conditions.empty()) return;
  for (const IvSweep& sweep : task.sweeps) {
    if (sweep.current_A.empty()) {
      throw s.error(fit_key::curves, "a curve without readings", "pairs of voltage and current");
    }
  }
  task.temperature_K = task.conditions[0].temperature_K;
  if (are_repeats(task.conditions)) task.conditions.clear();
}

// The open-circuit voltage of the device, at least that of its readings with a forward current.
double open_circuit_V(const FitTask& task) {
  double open_V = 0.0;
  for (const RatedPoint& p : task.datasheet) open_V = std::max(open_V, p.open_circuit_V);
  for (const IvSweep& sweep : task.sweeps) {
    for (size_t i = 0; i < std::min(sweep.voltage_V.size(), sweep.current_A.size()); ++i) {
      if (sweep.current_A[i] >= 0.0) open_V = std::max(open_V, sweep.voltage_V[i]);
    }
  }
  return open_V;
}

// Checks the open-circuit voltage per cell: between 0.3 V (moonlight) and 4.5 V (best
// multi-junction cells).
void check_cells(const Settings& s, const FitTask& task) {
  if (task.substrings > 0 && task.cells_in_series == 1) return;  // not stated
  const double open_V = open_circuit_V(task);
  constexpr double lowest_V = 0.1, highest_V = 5.0;
  const double one_V = open_V / task.cells_in_series;
  if (open_V == 0.0 || (one_V >= lowest_V && one_V <= highest_V)) return;
  throw s.error(fit_key::cells_in_series,
                std::to_string(task.cells_in_series) + " cells, of " + readable_number(one_V, 3) +
                    " V each at open circuit",
                "cells that give 0.1 to 5 V each of these " + readable_number(open_V, 3) + " V");
}

// Reads [fit] and its curves, relative to `folder`. Throws InputError for missing or contradictory
// keys, and for a number of cells in series that contradicts the voltage.
FitTask read_fit_task(const Settings& root, const fs::path& folder) {
  const Settings s = root.get(fit_key::fit);
  FitTask task;
  task.cells_in_series = static_cast<int>(s.get(fit_key::cells_in_series));
  task.temperature_K = s.get(fit_key::temperature);
  const bool has_curves = s.has(fit_key::curves) || s.has(fit_key::curve);
  const int sources = has_curves + s.has(fit_key::datasheet) + s.has(fit_key::module_file);
  if (sources != 1) {
    throw s.error(fit_key::curves, sources == 0 ? "nothing to fit" : "several things to fit",
                  "one of curves = [\"sweep.csv\"], [[fit.curve]], [[fit.datasheet]] and "
                  "module_file = \"library.csv\"");
  }
  if (s.has(fit_key::module_file)) {
    task.files.push_back(existing_file(s, fit_key::module_file, folder));
    task.module = module_in(whole_text(task.files[0]), task.files[0].string(),
                            s.has(fit_key::module_name) ? s.get(fit_key::module_name) : "");
    root.finish();
    return task;
  }
  const size_t law = s.get(fit_key::shunt);
  if (law > 0) task.shunt_law = static_cast<ShuntLaw>(law - 1);
  if (s.has(fit_key::datasheet)) {
    if (s.has(fit_key::temperature)) {
      throw s.error(fit_key::temperature, "a temperature in addition to a datasheet",
                    "temperature_K in [[fit.datasheet]]");
    }
    for (const Settings& point : s.get(fit_key::datasheet))
      task.datasheet.push_back(read_rated_point(point));
    task.slopes = read_rated_slopes(s);
    task.assumed_slopes = assumed_slopes(s);
    const RatedTolerance written = written_steps(task.datasheet);
    task.tolerance = {s.get_or(fit_key::rounding_current, written.step_A),
                      s.get_or(fit_key::rounding_voltage, written.step_V),
                      s.get(fit_key::tolerance)};
  } else {
    task.noise.current_fraction = s.get(fit_key::current_noise);
    task.noise.voltage_fraction = s.get(fit_key::voltage_noise);
    task.noise.correlation_points = s.get(fit_key::correlation_points);
    task.substrings = static_cast<int>(s.get(fit_key::substrings));
    read_curves(s, folder, task);
    if (task.substrings > 0 && task.cells_in_series > 1 &&
        task.cells_in_series % task.substrings != 0) {
      throw s.error(fit_key::cells_in_series, std::to_string(task.cells_in_series),
                    "a multiple of substrings, " + std::to_string(task.substrings));
    }
    if (task.substrings > 0 && s.has(fit_key::correlation_points)) {
      throw s.error(fit_key::correlation_points, "a correlation for a partly shaded string",
                    "no substrings: with several errors per point they are not supported");
    }
    if (!task.conditions.empty() && (task.substrings > 0 || s.has(fit_key::correlation_points) ||
                                     s.get(fit_key::even_voltage_steps))) {
      throw s.error(task.substrings > 0 ? fit_key::substrings.name : fit_key::curves.name,
                    "curves under different light or temperature",
                    "repeats under the same light with substrings, correlation_points or "
                    "even_voltage_steps");
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

// Scatter over the stated noise above which one diode does not describe the data.
constexpr double usual_scatter = 3.0;

// Checks the ideality: below 0.5 the curve is sharper than the thermal voltage of a junction
// allows; above 4 it is a leak. Where one diode does not describe the data, as print_misfit() says,
// the ideality means nothing.
void check_ideality(const SingleDiode& d, double scatter, const FitTask& task) {
  const double ideality = d.scale_V.value / task.thermal_V();
  constexpr double lowest = 0.5, highest = 4.0;
  if ((ideality >= lowest && ideality <= highest) || scatter > usual_scatter) return;
  // With fewer cells the ideality of one is larger, but so is its voltage.
  constexpr double junction_V = 0.3;
  if (ideality < lowest && open_circuit_V(task) > junction_V * task.cells_in_series) {
    std::string without;
    for (const std::string& note : task.notes) without += "; " + note;
    throw InputError({}, task.datasheet.empty() ? "fit.curves" : "fit.datasheet",
                     "an ideality of " + show(ideality) + " for each of " +
                         std::to_string(task.cells_in_series) + " cells" + without,
                     "the curve of one diode (an ideality of 1 to 2): this one falls faster near "
                     "open circuit, or the number of cells in series is smaller");
  }
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

// Rejects a fit with deviations of more than a tenth of the current.
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

// Warns about a large misfit. Errors are scaled with the scatter, but parameters of an unsuitable
// model are off by more than these errors.
void print_misfit(const Console& console, double scatter) {
  if (scatter < usual_scatter) return;
  console.line(
      "  warning: the scatter is " + readable_number(scatter, 3) +
      " times that of the stated noise: one diode does not describe these data. The errors "
      "follow from the scatter; `photorque diagnose` with [module] tests shade, cracks and other "
      "faults");
}

// States whether the irradiance of single readings is used, if any curve has it.
void print_light_note(const Console& console, const FitTask& task, bool uses_light) {
  if (std::ranges::all_of(task.sweeps, [](const IvSweep& s) { return s.light.empty(); })) return;
  console.line(uses_light ? std::string("  note: the irradiance of each reading is used; the "
                                        "photocurrent is at ") +
                                (task.sweeps.size() == 1 ? "its mean" : "the mean of each curve")
                          : "  note: the irradiance of each reading is not used: it doubles the "
                            "scatter");
}

// Prints the hysteresis: the difference between rising and falling voltage.
void print_storage(const Console& console, const ChargeStorage& storage,
                   std::vector<CellRow>& rows) {
  const std::string unit = storage.is_timed ? "s" : "readings";
  console.line("  note: hysteresis: rising and falling voltage differ by up to " +
               show(storage.largest_A) + " A; the charge stored in the junction, " +
               show(storage.time, unit.c_str()) +
               ", explains it, and the parameters are those of "
               "a slow sweep");
  rows.push_back({"charge_storage_" + unit, storage.time});
}

Product fit_even_light(const FitTask& task, const Console& console) {
  const SweepFit fit = fit_sweeps(task.sweeps, task.noise);
  check_rms(fit.rms_A, task);
  check_ideality(fit.diode, std::sqrt(fit.variance), task);
  std::vector<CellRow> rows = diode_rows(fit.diode, task);
  const CellCurve cell(fit.diode.parameters(task.temperature_K));
  const ArrayPoint best = best_point(cell, fit.diode.photocurrent_A.value);
  print_rows(console, rows);
  print_undetermined(console, rows);
  print_bounds(console, fit.bounds);
  print_ideality_note(console, fit.diode, task);
  print_left_out(console, task, fit.outliers);
  console.line("  rms of current " + show(fit.rms_A) + " A over " + std::to_string(fit.points) +
               " points; scatter " + readable_number(std::sqrt(fit.variance), 3) +
               " times that of the stated noise");
  print_misfit(console, std::sqrt(fit.variance));
  print_light_note(console, task, fit.uses_light);
  if (fit.storage) print_storage(console, *fit.storage, rows);
  console.line("  maximum " + show(best.power_W()) + " W at " + show(best.voltage_V) + " V");
  print_cell(console, fit.diode, task);
  rows.push_back({"rms_current_A", {fit.rms_A, 0.0}});
  rows.push_back({"maximum_power_W", {best.power_W(), 0.0}});
  Product product = parameter_product(rows);
  add_cell_plot(task, cell, fit.diode.photocurrent_A.value, product);
  return product;
}

// Adds the table "curves" and the plot of the first curve.
void add_curves(const FitTask& task, const ConditionsFit& fit, Product& product) {
  Table table = Table::of("curves", "The curves");
  for (size_t k = 0; k < fit.curves.size(); ++k) {
    const CurveAt& at = task.conditions[fit.curves[k].index];
    const double light_A = fit.curves[k].photocurrent_A.value;
    const CellCurve cell(in_light(parameters_at(fit.model, 1.0, at.temperature_K), light_A));
    const ArrayPoint best = best_point(cell, light_A);
    table.row()
        .set("curve", task.names[fit.curves[k].index])
        .set("irradiance_W_m2", at.irradiance_W_m2)
        .set("temperature_K", at.temperature_K)
        .set("photocurrent_A", light_A)
        .set("standard_error_A", fit.curves[k].photocurrent_A.standard_error)
        .set("rms_A", fit.curves[k].rms_A)
        .set("maximum_power_W", best.power_W());
    if (k == 0) {
      FitTask at_first = task;
      at_first.sweeps = {at.sweep};
      add_cell_plot(at_first, cell, light_A, product);
    }
  }
  product.tables.push_back(table);
}

Product fit_several_conditions(const FitTask& given, const Console& console) {
  const ConditionsFit fit = fit_conditions(given.conditions, given.noise, given.shunt_law);
  FitTask task = given;
  task.temperature_K = fit.model.reference.temperature_K;
  double worst_A = 0.0;
  for (const ConditionsFit::Curve& curve : fit.curves) worst_A = std::max(worst_A, curve.rms_A);
  check_rms(worst_A, task);
  check_ideality(fit.diode, std::sqrt(fit.variance), task);
  std::vector<CellRow> rows = diode_rows(fit.diode, task);
  const bool has_gap = fit.gap_error_eV > 0.0, has_light = fit.photocurrent_A_m2_W > 0.0;
  if (has_gap) rows.push_back({"gap_eV", {fit.model.gap_eV, fit.gap_error_eV}});
  if (has_gap && has_light) {
    rows.push_back({"photocurrent_slope_per_K",
                    {fit.model.photocurrent_slope_1_K, fit.photocurrent_slope_error_1_K}});
  }
  if (has_light) rows.push_back({"photocurrent_A_m2_W", {fit.photocurrent_A_m2_W, 0.0}});
  rows.push_back({"rms_fraction", {fit.rms, 0.0}});
  print_rows(console, rows);
  print_undetermined(console, rows);
  print_bounds(console, fit.bounds);
  print_ideality_note(console, fit.diode, task);
  print_left_out(console, task, fit.outliers);
  print_shunt_law(console, fit.shunt_law, "");
  if (fit.curves[0].index > 0) {
    console.line("  photocurrent and shunt are those of " + task.names[fit.curves[0].index]);
  }
  for (const ConditionsFit::Omitted& one : fit.omitted) {
    console.line("  note: left out " + task.names[one.index] + ": one diode leaves " +
                 show_percent(one.rms) +
                 " of its photocurrent (a shadow on a part, or a cloud); "
                 "fit it with substrings = N");
  }
  print_light_note(console, task,
                   std::ranges::any_of(fit.curves, &ConditionsFit::Curve::uses_light));
  console.line("  rms of current " + show_percent(fit.rms) + " of the photocurrent over " +
               std::to_string(fit.points) + " points of " + std::to_string(fit.curves.size()) +
               " curves; scatter " + readable_number(std::sqrt(fit.variance), 3) +
               " times that of the stated noise");
  print_misfit(console, std::sqrt(fit.variance));
  Product product = parameter_product(rows);
  add_curves(task, fit, product);
  print_cell(console, fit.diode, task, fit.model.reference);
  if (has_gap) print_key(console, "gap_eV", fit.model.gap_eV);
  if (has_gap) print_key(console, "gap_slope_per_K", fit.model.gap_slope_1_K);
  return product;
}

// Warns about the point whose stated maximum power the fitted cell misses most.
void print_power_misfit(const Console& console, const RatedFit& fit,
                        std::span<const RatedPoint> points) {
  constexpr double noticeable = 0.005;
  double worst = 0.0;
  std::string words;
  for (const RatedPoint& p : points) {
    const RatedPoint gives = fit.predict(p.irradiance_W_m2, p.temperature_K);
    const double stated_W = p.maximum_A * p.maximum_V, given_W = gives.maximum_A * gives.maximum_V;
    const double off = given_W / stated_W - 1.0;
    if (std::abs(off) < std::max(noticeable, worst)) continue;
    worst = std::abs(off);
    words = show(given_W) + " W for the stated " + show(stated_W) + " W (" + show_percent(off) +
            ") at " + show(p.irradiance_W_m2) + " W/m²";
  }
  if (words.empty()) return;
  console.line("  warning: these keys give " + words +
               ". Check cells_in_series (half-cells in two parallel chains count once), and V_oc, "
               "I_sc and the maximum for errors");
}

Product fit_datasheet(const FitTask& task, const Console& console) {
  const double guess_V = 1.2 * task.cells_in_series * boltzmann_J_K *
                         task.datasheet[0].temperature_K / elementary_charge_C;
  const RatedFit fit =
      fit_rated_points(task.datasheet, task.slopes, guess_V, task.tolerance, task.shunt_law);
  FitTask at_first = task;
  at_first.temperature_K = task.datasheet[0].temperature_K;
  check_ideality(fit.diode, fit.rms_over_known, at_first);
  // The search for the gap ends at these limits for any slope.
  constexpr double lowest_eV = 0.3, highest_eV = 4.0;
  if (!(fit.model.gap_eV > lowest_eV && fit.model.gap_eV < highest_eV)) {
    throw InputError({}, "fit.open_circuit_slope_per_K",
                     show(task.slopes.open_circuit_1_K) + ", which takes a gap of " +
                         show(fit.model.gap_eV) + " eV",
                     "a fraction of the open-circuit voltage per kelvin, about -0.003");
  }
  std::vector<CellRow> rows = diode_rows(fit.diode, at_first);
  const bool is_assumed = !task.assumed_slopes.empty();
  rows.push_back({"gap_eV",
                  {fit.model.gap_eV, is_assumed ? 0.0 : fit.gap_error_eV},
                  is_assumed ? CellRow::Is::assumed : CellRow::Is::value});
  rows.push_back({"rms_fraction", {fit.rms, 0.0}});
  print_rows(console, rows);
  print_bounds(console, fit.bounds);
  const RatedTolerance& t = task.tolerance;
  console.line(
      "  errors: of figures rounded to " + show(t.step_A) + " A and " + show(t.step_V) + " V" +
      (t.fraction > 0.0 ? ", each good to " + show_percent(t.fraction) + " (one sigma)" : "") +
      (task.datasheet.size() == 1 ? "; one point leaves the ideality as assumed" : ""));
  if (is_assumed) {
    console.line("  note: assumed, since not stated: " + task.assumed_slopes +
                 "; gap and temperature slopes follow from it");
  }
  print_shunt_law(console, fit.shunt_law,
                  fit.other_rms > 0.0 ? "; the other law leaves " + show(fit.other_rms) : "");
  print_power_misfit(console, fit, task.datasheet);
  if (fit.rms_over_known > usual_scatter && task.datasheet.size() > 1) {
    console.line("  warning: the figures are off by " + show(fit.rms) + " (rms), " +
                 show(fit.rms_over_known) +
                 " times their rounding: one diode with such a shunt does not describe them; "
                 "tolerance = N states how well they are known");
  }
  print_cell(console, fit.diode, at_first, fit.model.reference);
  print_key(console, "gap_eV", fit.model.gap_eV);
  print_key(console, "gap_slope_per_K", fit.model.gap_slope_1_K);
  print_key(console, "photocurrent_slope_per_K", fit.model.photocurrent_slope_1_K);
  const CellCurve cell(fit.model.reference);
  Product product = parameter_product(rows);
  add_cell_plot(task, cell, fit.diode.photocurrent_A.value, product);
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
  print_left_out(console, task, {});
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

FitTask task_of(const RunOptions& options) {
  return read_fit_task(Settings(options.settings(options.overrides)),
                       options.experiment.parent_path());
}

}  // namespace

std::string describe_fit(const RunOptions& options) {
  const FitTask task = task_of(options);
  const std::string cells = std::to_string(task.cells_in_series) + " in series";
  if (task.module) return "a module of a library: " + task.module->name;
  if (!task.datasheet.empty()) {
    return std::to_string(task.datasheet.size()) + " point(s) of a datasheet, cells: " + cells;
  }
  return std::to_string(task.sweeps.size()) + " sweep(s), cells: " + cells;
}

RunResult run_fit_cell(const RunOptions& options, const Console& console) {
  const WallTime wall;
  const std::string text = options.experiment_text();
  const FitTask task = task_of(options);
  Provenance provenance = build_provenance();
  provenance.inputs.emplace_back(options.experiment.filename().string(), content_hash(text));
  for (const std::string& assignment : options.overrides)
    provenance.inputs.emplace_back("--set", assignment);
  for (const fs::path& file : task.files) {
    provenance.inputs.emplace_back(file.filename().string(), content_hash(read_file(file)));
  }
  Product product = task.module                ? list_module(*task.module, console)
                    : !task.datasheet.empty()  ? fit_datasheet(task, console)
                    : task.substrings > 0      ? fit_uneven_light(task, console)
                    : !task.conditions.empty() ? fit_several_conditions(task, console)
                                               : fit_even_light(task, console);
  return {std::move(product), std::move(provenance), {wall.elapsed_s(), {}}};
}

}  // namespace photorque

namespace photorque::verbs::fit_cell {

Verb kind() {
  return {"fit-cell",
          "Solar cell parameters, with errors, from current-voltage sweeps or a datasheet",
          command_that_writes(experiment_options, run_fit_cell),
          {"fit"},
          "[fit]",
          [](const RunOptions& options) { return run_fit_cell(options, Console()); }};
}

}  // namespace photorque::verbs::fit_cell
