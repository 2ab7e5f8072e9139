#include "tools/runs/array_report.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/constants.h"
#include "raytrace/receiver.h"
#include "tools/runs/array_power.h"

namespace photorque {
namespace {

// ---- Physical requirements of a published power and efficiency.

// Computed value for a published power of the array; empty for other figures.
std::optional<double> power_of(const ArrayResult& result, const std::string& quantity) {
  if (quantity == "array_power_W") return result.power_W.value;
  if (quantity == "power_of_cells_alone_W") return result.sum_of_cells_W.value;
  return std::nullopt;
}

void print_requirements(const Console& console, const ArrayTarget& target,
                        const ArrayResult& result, const LossInputs& light) {
  const double needed_V = target.efficiency * light.photon_V;
  console.heading("Requirements of " + show(target.power_W) + " W and " +
                  show_percent(target.efficiency));
  console.line("  a photon has " + show(light.photon_V) + " eV: at most " +
               show(1.0 / light.photon_V) + " A/W; " + show_percent(target.efficiency) +
               " needs EQE V_oc FF = " + show(needed_V) + " V");
  const double ours = result.efficiency.value;
  console.line("  light on the cells for it: " + show(target.power_W / target.efficiency) + " W" +
               (ours > 0.0 ? "; at this array's " + show_percent(ours) + ": " +
                                 show(target.power_W / ours) + " W"
                           : ""));
}

// Published powers of the tilted array, compared with the cosine of its tilt. A lower published
// power indicates further losses.
Table tilted_table(const Console& console, const ArrayTarget& target,
                   const std::vector<PublishedFigure>& published, const ArrayResult& result,
                   double tilt_rad) {
  Table table = Table::of("target", "Published powers of the tilted array");
  for (const PublishedFigure& figure : published) {
    const auto ours_W = power_of(result, figure.quantity);
    constexpr double edge_on = 1e-6;
    if (!ours_W || figure.tilt_rad < same_tilt_rad || std::cos(figure.tilt_rad) < edge_on) continue;
    const double cosine_W = target.power_W * std::cos(figure.tilt_rad);
    const double degrees = figure.tilt_rad / degree_rad;
    const bool here = std::abs(figure.tilt_rad - tilt_rad) < same_tilt_rad;
    console.line(
        "  at " + show(degrees) + " deg: " + show(target.power_W) + " W cos = " + show(cosine_W) +
        " W; the published " + show(figure.value) + " W need a further " +
        show(figure.value / cosine_W) + ", from spill and uneven light" +
        (here ? "; here " + figure.quantity + " is " + show(*ours_W) + ", " +
                    show(*ours_W / cosine_W) + " of it, and the array gives " +
                    show(result.power_W.value) + " W, " + show(result.power_W.value / cosine_W)
              : ""));
    const double none = std::nan("");
    table.row()
        .set("quantity", figure.quantity)
        .set("tilt_deg", degrees)
        .set("published_W", figure.value)
        .set("cosine_W", cosine_W)
        .set("further_factor", figure.value / cosine_W)
        .set("ours_W", here ? *ours_W : none)
        .set("our_further_factor", here ? *ours_W / cosine_W : none);
  }
  return table;
}

Table known_cell_table(const Console& console, const ArrayDesign& design, const LossInputs& light,
                       double irradiance_W_m2) {
  Table known = Table::of("known_cells", "Known cells in this light");
  for (const double irradiance : {1000.0, irradiance_W_m2}) {
    if (!(irradiance > 0.0)) continue;  // the array is dark
    console.line("  known cells at " + show(irradiance) + " W/m²:");
    for (const CellFigures& f : known_cell_figures(
             irradiance, light.photon_V, light.quantum_efficiency, design.temperature_K)) {
      console.line("    " + padded(f.name, 30) + "EQE V_oc FF " +
                   padded(show(f.product_V) + " V", 12) + show_percent(f.efficiency));
      known.row()
          .set("cell", f.name)
          .set("irradiance_W_m2", irradiance)
          .set("open_circuit_V", f.open_circuit_V)
          .set("fill_factor", f.fill_factor)
          .set("eqe_voc_ff_V", f.product_V)
          .set("efficiency", f.efficiency);
    }
  }
  return known;
}

Table sensitivity_table(const Console& console, const ArrayDesign& design,
                        const ArrayResult& result) {
  Table table = Table::of("sensitivities", "Sensitivity of the power");
  console.line("  sensitivity of the power:");
  for (const ArraySensitivity& s : sensitivities(design, result)) {
    console.line("    " + padded(s.change, 34) + show_percent(s.relative));
    table.row().set("change", s.change).set("power_W", s.power_W).set("relative", s.relative);
  }
  return table;
}

// Requirements of the target (EQE V_oc FF, light on the cells), the power at tilts with published
// powers, the figures of known cells, and the sensitivities of this array. Tables "target",
// "known_cells", "sensitivities". InputError for a figure that is neither given nor published.
Product target_report(const Console& console, const ArrayTarget& target,
                      const std::vector<PublishedFigure>& published, const ArrayDesign& design,
                      const ArrayResult& result, const LossInputs& light, double tilt_rad) {
  Product product;
  print_requirements(console, target, result, light);
  Table tilted = tilted_table(console, target, published, result, tilt_rad);
  if (!tilted.columns.empty()) product.tables.push_back(std::move(tilted));
  const double irradiance = result.power_on_cells_W.value / result.area_of_cells_m2;
  product.tables.push_back(known_cell_table(console, design, light, irradiance));
  product.tables.push_back(sensitivity_table(console, design, result));
  return product;
}

// ---- Trackers, losses, a day, the wiring.

CellTables tables_for(const ArrayPower& array, const ArrayResult& result,
                      const std::vector<std::vector<double>>& lights) {
  double max_A = 0.0;
  for (const auto& light : lights) max_A = std::max(max_A, *std::ranges::max_element(light));
  return cell_tables(array.design, result.cell_area_m2, max_A);
}

Product tracker_product(const std::vector<TrackerRun>& runs) {
  Product product;
  Table table = Table::of("trackers", "Trackers while the platform moves");
  Plot plot{"tracking", "Trackers while the platform moves", "time [s]", "power [W]"};
  Plot::Panel voltage{"voltage [V]"};
  for (const TrackerRun& run : runs) {
    const std::string name = name_of(run.tracker.kind);
    table.row()
        .set("tracker", name)
        .set("efficiency", run.efficiency)
        .set("false_maximum_s", run.false_maximum_s)
        .set("energy_J", run.energy_J)
        .set("best_energy_J", run.best_energy_J);
    if (plot.curves.empty()) {
      plot.curves.push_back({"global maximum", run.time_s, run.best_W});
      voltage.curves.push_back({"global maximum", run.time_s, run.best_V});
    }
    plot.curves.push_back({name, run.time_s, run.power_W});
    voltage.curves.push_back({name, run.time_s, run.voltage_V});
    product.quantities.push_back({"tracking_efficiency_" + name, {run.efficiency, 0.0}});
    product.quantities.push_back({"false_maximum_" + name + "_s", {run.false_maximum_s, 0.0}});
  }
  plot.below.push_back(voltage);
  product.tables.push_back(table);
  product.plots.push_back(plot);
  return product;
}

void print_trackers(const Console& console, const std::vector<TrackerRun>& runs) {
  console.heading("Trackers over " + show(runs.front().duration_s) + " s of motion");
  for (const TrackerRun& run : runs) {
    console.line("  " + padded(name_of(run.tracker.kind), 26) + show_percent(run.efficiency) +
                 " of the energy at the global maximum; on a false maximum for " +
                 show(run.false_maximum_s) + " s");
  }
}

LossInputs loss_inputs(const ArrayPower& array, const OpticalRun& run, const TraceResult& traced) {
  LossInputs in;
  in.emitted_W = traced.power_balance.emitted_W;
  const ArrayLight light = light_on(array, run, traced.sums);
  const std::vector<double> bins_W = mean_bins(light.power_W);
  const auto bands = static_cast<size_t>(light.bands);
  double current_A = 0.0, ideal_A = 0.0;
  for (size_t i = 0; i < bins_W.size(); ++i) {
    in.on_receiver_W += bins_W[i];
    current_A += bins_W[i] * array.responsivity_A_W[i % bands];
    ideal_A += bins_W[i] * array.ideal_responsivity_A_W[i % bands];
  }
  if (ideal_A > 0) {
    in.photon_V = in.on_receiver_W / ideal_A;
    in.quantum_efficiency = current_A / ideal_A;
  }
  in.is_bifacial = array.back_map.has_value();
  in.wall_plug_efficiency = array.report.chain.wall_plug;
  in.collimator_efficiency = array.report.chain.collimator;
  in.converter_efficiency = array.report.chain.converter;
  return in;
}

// Fraction lost between two stages. Rounding can make it slightly negative; then it is zero.
double lost_fraction(const LossStage& before, const LossStage& after) {
  const double lost = 1.0 - after.power_W / before.power_W;
  return lost > 1e-12 ? lost : 0.0;
}

void print_losses(const Console& console, const std::vector<LossStage>& stages) {
  console.heading("From the light to the load");
  for (size_t i = 0; i < stages.size(); ++i) {
    std::string line =
        "  " + padded(stages[i].name, 30) + padded(show_brief(stages[i].power_W) + " W", 14);
    if (i > 0 && stages[i - 1].power_W > 0) {
      line += show_percent(lost_fraction(stages[i - 1], stages[i])) + " lost to " + stages[i].loss;
    }
    console.line(line);
  }
}

void print_uniformity(const Console& console, const Table& table) {
  console.heading("Uniformity of the light");
  const auto& cells = table.column("cells").texts;
  for (size_t i = 0; i < cells.size(); ++i) {
    console.line("  " + padded(cells[i], 12) + "mean " + show(table.column("mean_W_m2").values[i]) +
                 " W/m², least over mean " + show(table.column("minimum_over_mean").values[i]) +
                 ", variation " + show_percent(table.column("variation").values[i]));
  }
}

Product day_report(const Console& console, const ArrayDesign& design, DaySettings settings,
                   const ArrayResult& result, double tracker_efficiency) {
  settings.tracker_efficiency = tracker_efficiency;
  const DayResult day = run_day(design, result, settings);
  const double hours = settings.duration_s / 3600.0;
  const double capacity_Wh = settings.battery.capacity_J / 3600.0;
  console.heading("Array and battery over " + show(hours) + " h");
  console.line("  cells end at            " + show(day.temperature_K.back()) + " K, array at " +
               show(day.array_W.back()) + " W, " + show(day.mean_array_W) + " W on average");
  console.line("  load of " + show(settings.load_W) + " W needs " + show(settings.load_W * hours) +
               " Wh; the battery holds " + show(capacity_Wh) + " Wh, which is " +
               show(capacity_Wh / hours) + " W over the same time");
  if (settings.load_W > 0.0) {
    const double usable_Wh =
        capacity_Wh * settings.battery.charge * settings.battery.discharge_efficiency;
    console.line("  battery alone           " + show(usable_Wh / settings.load_W) + " h");
  }
  console.line(day.empty_after_s
                   ? "  battery is empty after  " + show(*day.empty_after_s / 3600.0) + " h"
                   : "  battery ends at         " + show(day.charge_J.back() / 3600.0) + " Wh");
  return day_product(day);
}

Product layout_report(const Console& console, const ArrayPower& array, const CellTables& tables,
                      const std::vector<std::vector<double>>& lights) {
  const LayoutResult found =
      search_layout(array.design.wiring, tables, lights, *array.report.layout_most_tried);
  console.heading("Wiring for " + std::to_string(lights.size()) + " attitude" +
                  (lights.size() == 1 ? "" : "s") +
                  (found.exact ? ", no better one exists" : ", by exchanges"));
  const double gap = found.bound_W / found.power_W - 1.0;
  console.line("  as given " + show(found.start_power_W) + " W, best found " + show(found.power_W) +
               " W, no wiring above " + show(found.bound_W) + " W" +
               (gap > 1e-9 ? " (" + show_percent(gap) + " more)" : "") + "; " +
               std::to_string(found.tried) + " tried");
  std::string wiring = "[";
  Table table = Table::of("layout", "Best wiring found");
  for (size_t s = 0; s < found.wiring.strings.size(); ++s) {
    wiring += s ? ", [" : "[";
    for (size_t b = 0; b < found.wiring.strings[s].substrings.size(); ++b) {
      wiring += b ? ", [" : "[";
      const auto& rows = found.wiring.strings[s].substrings[b].rows;
      for (size_t r = 0; r < rows.size(); ++r) {
        wiring += (r ? ", " : "") + std::to_string(rows[r].cell);
        table.row()
            .set("cell", rows[r].cell)
            .set("string", static_cast<double>(s + 1))
            .set("substring", static_cast<double>(b + 1));
      }
      wiring += "]";
    }
    wiring += "]";
  }
  console.line("  wiring = " + wiring + "]");
  Product product;
  product.quantities = {{"layout_power_W", {found.power_W, 0.0}},
                        {"layout_bound_W", {found.bound_W, 0.0}}};
  product.tables.push_back(table);
  return product;
}

}  // namespace

Product report_array(const Console& console, const OpticalRun& run, const ArrayPower& read,
                     const TraceResult& traced, const ArrayResult& result) {
  Product product;
  ArrayPower array = read;  // at the temperature of `result`
  array.design.temperature_K = result.temperature_K.value;
  array.design.heat.reset();
  const ArrayReport& report = array.report;
  std::vector<std::vector<double>> lights = {result.cell_photocurrent_A};
  LossInputs in = loss_inputs(array, run, traced);
  if (report.motion && !report.motion->time_s.empty()) {
    lights.clear();
    for (size_t k = 0; k < report.motion->time_s.size(); ++k) {
      const TraceResult at =
          run.run(lab_from_body_at(report.motion->tilt_rad[k], report.motion->heading_rad[k]), {});
      lights.push_back(evaluate(array, run, at).cell_photocurrent_A);
    }
    const std::vector<TrackerRun> runs =
        run_trackers(report.motion->trackers, array.design.wiring,
                     tables_for(array, result, lights), {report.motion->time_s, lights});
    print_trackers(console, runs);
    append(product, tracker_product(runs));
    in.tracker_efficiency = runs.front().efficiency;
  }
  const std::vector<LossStage> stages = loss_waterfall(result, in);
  print_losses(console.details(), stages);
  append(product, loss_product(stages));
  const Table even = uniformity_table(result, array.design.wiring);
  print_uniformity(console.details(), even);
  product.tables.push_back(even);
  if (report.target) {
    const Attitude& attitude = run.experiment().file.attitude;
    append(product, target_report(console, *report.target, report.published, array.design, result,
                                  in, attitude.tilt_rad));
  }
  if (report.day) {
    ArrayDesign design = array.design;
    design.heat = read.design.heat;  // the temperature changes during the day
    append(product,
           day_report(console, design, *report.day, result, in.tracker_efficiency.value_or(1.0)));
  }
  if (report.layout_most_tried)
    append(product, layout_report(console, array, tables_for(array, result, lights), lights));
  return product;
}

}  // namespace photorque
