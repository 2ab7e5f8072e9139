#include "tools/verbs/fitted_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/text/format.h"
#include "photovoltaics/cell/response.h"

namespace photorque {
namespace {

using Is = CellRow::Is;

// Whether the standard error of a positive number is smaller than the number.
bool is_determined(const CellRow& row) {
  return row.is != Is::value || row.estimate.standard_error < row.estimate.value ||
         row.estimate.standard_error == 0.0;
}

std::string words_of(const CellRow& row) {
  const std::string value = show(row.estimate.value);
  if (row.is == Is::lower_limit) return "above " + value + " (95 %): no leakage is detected";
  if (row.is == Is::upper_limit) return "below " + value + " (95 %)";
  if (row.is == Is::assumed) return value + ", from an assumed slope";
  // An error of ten times the number means that it is not determined.
  constexpr double hopeless = 10.0;
  if (!(row.estimate.standard_error < hopeless * std::abs(row.estimate.value)) &&
      !is_determined(row)) {
    return "not determined; the best fit has " + value;
  }
  return show(row.estimate, "");
}

const char* kind_of(const CellRow& row) {
  if (row.is == Is::lower_limit) return "lower limit";
  if (row.is == Is::upper_limit) return "upper limit";
  if (row.is == Is::assumed) return "assumed";
  return std::isfinite(row.estimate.standard_error) ? "value" : "not determined";
}

}  // namespace

double FitTask::thermal_V() const {
  return cells_in_series * boltzmann_J_K * temperature_K / elementary_charge_C;
}

std::vector<CellRow> diode_rows(const SingleDiode& d, const FitTask& task) {
  const double per_cell = 1.0 / task.thermal_V();
  std::vector<CellRow> rows = {
      {"photocurrent_A", d.photocurrent_A},
      {"saturation_A", d.saturation_A},
      {"ideality", {d.scale_V.value * per_cell, d.scale_V.standard_error * per_cell}},
      {"series_ohm", d.series_ohm},
      {"shunt_ohm", d.shunt_ohm}};
  if (d.series_below_ohm) rows[3] = {"series_below_ohm", {*d.series_below_ohm}, Is::upper_limit};
  if (d.shunt_above_ohm) rows[4] = {"shunt_above_ohm", {*d.shunt_above_ohm}, Is::lower_limit};
  return rows;
}

Product parameter_product(const std::vector<CellRow>& rows) {
  Product product;
  Table table = Table::of("parameters", "Fitted parameters");
  for (const CellRow& row : rows) {
    product.quantities.push_back({row.name, row.estimate});
    const bool has_error = row.is == Is::value && std::isfinite(row.estimate.standard_error);
    table.row()
        .set("parameter", row.name)
        .set("is", kind_of(row))
        .set("value", row.estimate.value)
        .set("standard_error",
             has_error ? row.estimate.standard_error : std::numeric_limits<double>::quiet_NaN());
  }
  product.tables.push_back(table);
  return product;
}

void print_rows(const Console& console, const std::vector<CellRow>& rows) {
  console.heading("Fitted parameters (± standard error)");
  for (const CellRow& row : rows) {
    // A limit is printed with the name of its parameter.
    std::string name = row.name;
    const bool is_limit = row.is == Is::lower_limit || row.is == Is::upper_limit;
    if (is_limit) name = name.substr(0, name.find('_')) + "_ohm";
    console.line("  " + padded(name, 26) + words_of(row));
  }
}

void print_undetermined(const Console& console, const std::vector<CellRow>& rows) {
  std::string names;
  for (const CellRow& row : rows) {
    if (!is_determined(row)) names += (names.empty() ? "" : ", ") + row.name;
  }
  if (!names.empty()) console.line("  these data do not determine " + names);
}

void print_bounds(const Console& console, const std::vector<BoundReached>& bounds) {
  for (const BoundReached& bound : bounds) {
    console.line("  warning: " + bound.key + " is at its bound, " +
                 readable_number(bound.value, 3) + ": " + bound.meaning);
  }
}

void print_key(const Console& console, const char* name, double value, const std::string& comment) {
  console.line(printed("  %s = %.9g", name, value) + (comment.empty() ? "" : "   # " + comment));
}

void print_cell(const Console& console, const SingleDiode& d, const FitTask& task,
                const CellParameters& reference) {
  const double cells = task.cells_in_series;
  console.heading("One cell, for [array.cell_parameters]");
  print_key(console, "saturation_1_A", d.saturation_A.value);
  print_key(console, "ideality_1", d.scale_V.value / task.thermal_V());
  const auto print_ohm = [&](const char* name, const std::optional<double>& limit, double value,
                             const std::string& bound) {
    print_key(console, name, value / cells,
              limit ? "not determined: " + (bound + show(*limit / cells)) + " (95 %)" : "");
  };
  print_ohm("series_ohm", d.series_below_ohm, d.series_ohm.value, "below ");
  print_ohm("shunt_ohm", d.shunt_above_ohm, d.shunt_ohm.value, "above ");
  if (reference.shunt_light_A > 0.0) {
    print_key(console, "shunt_photocurrent_A", reference.shunt_light_A);
    if (std::isfinite(reference.shunt_dark_ohm)) {
      print_key(console, "shunt_dark_ohm", reference.shunt_dark_ohm / cells);
      print_key(console, "shunt_exponent", reference.shunt_exponent);
    }
  }
  print_key(console, "reference_temperature_K", task.temperature_K);
  constexpr double square_centimetre_m2 = 1e-4;
  if (task.is_density) {
    print_key(console, "reference_area_m2", square_centimetre_m2);
  } else {
    console.line("  reference_area_m2 =   # to be filled in: the area of one cell");
  }
}

// Residual of each measured point from the fitted curve, which is interpolated linearly.
Plot::Curve residuals_of(const Plot::Curve& measured, const Plot::Curve& fitted) {
  Plot::Curve left{"", measured.x, {}, {}, true};
  for (size_t i = 0; i < measured.x.size(); ++i) {
    const auto above = std::upper_bound(fitted.x.begin(), fitted.x.end(), measured.x[i]);
    const auto last = static_cast<std::ptrdiff_t>(fitted.x.size()) - 1;
    const auto k =
        static_cast<size_t>(std::clamp<std::ptrdiff_t>(above - fitted.x.begin(), 1, last));
    const double t = (measured.x[i] - fitted.x[k - 1]) / (fitted.x[k] - fitted.x[k - 1]);
    left.y.push_back(measured.y[i] - (1.0 - t) * fitted.y[k - 1] - t * fitted.y[k]);
  }
  return left;
}

void add_fit_plot(const FitTask& task, const std::vector<ArrayPoint>& fitted,
                  const std::vector<ArrayPoint>& maxima, Product& product) {
  Plot plot{"fit", "Measured and fitted", "voltage [V]", "current [A]"};
  Plot::Panel power{"power [W]"};
  Plot::Curve measured{"measured", {}, {}, {}, true}, line{"fitted"};
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
  if (line.x.size() > 1) {
    plot.below.push_back({"residual [A]", {residuals_of(measured, line)}, false, {0.0}});
  }
  product.plots.push_back(plot);
}

namespace {

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

}  // namespace

ArrayPoint best_point(const CellCurve& cell, double light_A) {
  const CellOperatingPoint best = cell.maximum_power(light_A);
  return {best.voltage_V, best.current_A};
}

void add_cell_plot(const FitTask& task, const CellCurve& cell, double light_A, Product& product) {
  add_fit_plot(task, cell_points(cell, light_A), {best_point(cell, light_A)}, product);
}

namespace {

// The peak of silicon's quantum efficiency that gives the photocurrent of a cell of the module in
// AM1.5G sunlight. Requires the area of the module.
double efficiency_peak_of(const ListedModule& module) {
  const WeighedSpectrum sunlight[] = {{{.shape = Spectrum::Shape::am15g}}};
  const double amperes_W = band_responsivity_A_W(
      quantum_efficiency_of("silicon_interdigitated", 1.0), Bands{}, sunlight)[0];
  return module.photocurrent_A /
         (amperes_W * module.rated.irradiance_W_m2 * module.cell.reference_area_m2);
}

}  // namespace

Product list_module(const ListedModule& module, const Console& console) {
  const CellParameters& p = module.cell.reference;
  const RatedPoint& rated = module.rated;
  const RatedPoint gives = module.predict(rated.irradiance_W_m2, rated.temperature_K);
  const double listed_W = rated.maximum_A * rated.maximum_V;
  const double given_W = gives.maximum_A * gives.maximum_V;
  console.heading(module.name);
  console.line("  " + std::to_string(module.cells_in_series) + " cells in series" +
               (module.strings > 1 ? ", " + std::to_string(module.strings) + " in parallel" : ""));
  console.line("  maximum power " + show(given_W) + " W, listed " + show(listed_W) + " W, at " +
               show(rated.irradiance_W_m2) + " W/m² and " + show(rated.temperature_K) + " K");
  for (const std::string& note : module.notes) console.line("  note: " + note);
  constexpr double usual = 0.01;
  if (std::abs(given_W - listed_W) > usual * listed_W) {
    console.line("  warning: the circuit and the listed maximum power differ by " +
                 show_percent(given_W / listed_W - 1.0));
  }
  const bool has_area = module.area_m2 > 0.0, is_exponential = std::isfinite(p.shunt_dark_ohm);
  std::vector<CellRow> rows = {{"saturation_1_A", {p.saturation_1_A}},
                               {"ideality_1", {p.ideality_1}},
                               {"series_ohm", {p.series_ohm}},
                               {"shunt_ohm", {p.shunt_ohm}},
                               {"shunt_photocurrent_A", {p.shunt_light_A}}};
  if (is_exponential) rows.push_back({"shunt_dark_ohm", {p.shunt_dark_ohm}});
  if (is_exponential) rows.push_back({"shunt_exponent", {p.shunt_exponent}});
  rows.push_back({"gap_eV", {module.cell.gap_eV}});
  rows.push_back({"gap_slope_per_K", {module.cell.gap_slope_1_K}});
  rows.push_back({"photocurrent_slope_per_K", {module.cell.photocurrent_slope_1_K}});
  rows.push_back({"reference_temperature_K", {p.temperature_K}});
  if (has_area) rows.push_back({"reference_area_m2", {module.cell.reference_area_m2}});
  console.heading("One cell, for [array.cell_parameters]");
  for (const CellRow& row : rows) print_key(console, row.name.c_str(), row.estimate.value);
  if (!has_area) console.line("  reference_area_m2 =   # to be filled in: the area of one cell");
  if (has_area) {
    const double peak = efficiency_peak_of(module);
    console.heading("For [array]: this photocurrent in AM1.5G sunlight");
    print_key(console, "quantum_efficiency_peak", peak);
    if (peak > 1.0) {
      console.line(
          "  warning: above 1: this photocurrent needs another quantum efficiency than that shape "
          "([array.quantum_efficiency]), or the listed area is too small");
    }
    rows.push_back({"quantum_efficiency_peak", {peak}});
  }
  rows.push_back({"photocurrent_A", {module.photocurrent_A}});
  rows.push_back({"maximum_power_W", {given_W}});
  Product product = parameter_product(rows);
  add_cell_plot({}, CellCurve(in_light(p, module.photocurrent_A)), module.photocurrent_A, product);
  return product;
}

void print_left_out(const Console& console, const FitTask& task,
                    const std::vector<OutlierReading>& outliers) {
  for (const std::string& note : task.notes) console.line("  note: " + note);
  if (outliers.empty()) return;
  std::string where;
  constexpr size_t shown = 5;
  for (size_t i = 0; i < std::min(shown, outliers.size()); ++i) {
    where += (i > 0 ? ", " : "") + show(outliers[i].voltage_V) + " V " +
             show(outliers[i].current_A) + " A";
  }
  console.line("  note: left out " + std::to_string(outliers.size()) +
               " outliers, more than eight errors off: " + where +
               (outliers.size() > shown ? ", …" : ""));
}

void print_shunt_law(const Console& console, ShuntLaw law, const std::string& more) {
  console.line(std::string("  shunt: ") +
               (law == ShuntLaw::constant  ? "constant"
                : law == ShuntLaw::inverse ? "inversely proportional to the light"
                                           : "exponential in the light (PVsyst)") +
               more);
}

}  // namespace photorque
