#include "photovoltaics/array/losses.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace photorque {

namespace {

// Removes differences that are due to the rounding of sums.
double without_rounding(double power_W, double next_W) {
  constexpr double rounding = 1e-12;
  return std::abs(power_W - next_W) < rounding * std::abs(next_W) ? next_W : power_W;
}

}  // namespace

std::vector<LossStage> loss_waterfall(const ArrayResult& array, const LossInputs& in) {
  std::vector<LossStage> stages;
  const double lamps_W = in.emitted_W / in.collimator_efficiency.value_or(1.0);
  if (in.wall_plug_efficiency) {
    stages.push_back({"electric power of the lamps", lamps_W / *in.wall_plug_efficiency, ""});
  }
  if (in.collimator_efficiency) {
    stages.push_back({"light of the lamps", lamps_W, "heat in the lamps"});
  }
  stages.push_back({"light emitted", in.emitted_W,
                    in.collimator_efficiency ? "collimators" : "heat in the lamps"});
  stages.push_back({"light on the receiver", in.on_receiver_W, "spill and obstacles"});
  const double on_cells_W = array.power_on_cells_W.value;
  stages.push_back({"light on the cells", on_cells_W, "gaps between the cells"});
  const double entering_W = array.power_entering_W.value;
  if (array.entry_known) {
    stages.push_back({"light that enters", entering_W,
                      in.is_bifacial ? "angle of incidence, bifaciality" : "angle of incidence"});
  }
  stages.push_back({"photons converted", entering_W * in.quantum_efficiency,
                    "quantum efficiency, reflection included"});
  double cells_W = 0.0;
  for (size_t i = 0; i < array.cells.voltages_V.size(); ++i) {
    cells_W += array.cells.voltages_V[i] * array.cells.currents_A[i];
  }
  double left_W = array.power_W.value;
  cells_W = without_rounding(cells_W, left_W);
  stages.push_back({"sum of cell maxima", without_rounding(array.sum_of_cells_W.value, cells_W),
                    "voltage below the photon's, fill factor"});
  stages.push_back({"cells in the network", cells_W, "uneven light"});
  stages.push_back({"array", left_W, "bypass and blocking diodes"});
  if (in.tracker_efficiency) {
    left_W *= *in.tracker_efficiency;
    stages.push_back({"array with tracker", left_W, "tracker"});
  }
  if (in.converter_efficiency) {
    left_W *= *in.converter_efficiency;
    stages.push_back({"load and battery", left_W, "DC/DC converter"});
  }
  return stages;
}

Product loss_product(const std::vector<LossStage>& stages) {
  Product product;
  Table table = Table::of("losses", "From the light to the load");
  Plot plot{"loss_waterfall", "From the light to the load", "", "power [W]"};
  // Adds a bar from one power to another, with its name below it.
  const auto add_bar = [&](const std::string& label, double from_W, double to_W,
                           Plot::Colour colour) {
    const auto place = static_cast<double>(plot.curves.size() + 1);
    Plot::Curve bar{label, {place, place}, {from_W, to_W}, {}, false, true};
    bar.colour = colour;
    plot.curves.push_back(std::move(bar));
  };
  for (size_t i = 0; i < stages.size(); ++i) {
    const LossStage& stage = stages[i];
    const double before_W = i == 0 ? stage.power_W : stages[i - 1].power_W;
    table.row()
        .set("stage", stage.name)
        .set("lost_to", i == 0 ? "-" : stage.loss)
        .set("power_W", stage.power_W)
        .set("lost_W", before_W - stage.power_W)
        .set("kept", before_W > 0 ? stage.power_W / before_W : 0.0);
    if (i == 0) {
      add_bar(stage.name, 0.0, stage.power_W, Plot::Colour::blue);
    } else {
      add_bar(stage.loss, before_W, stage.power_W, Plot::Colour::vermilion);
    }
  }
  if (stages.size() > 1) {
    add_bar(stages.back().name, 0.0, stages.back().power_W, Plot::Colour::blue);
  }
  product.tables.push_back(table);
  product.plots.push_back(plot);
  return product;
}

Uniformity uniformity(const ArrayResult& array, std::span<const int> cells) {
  Uniformity u;
  double least = 1e300, squares = 0.0;
  const auto count = static_cast<double>(cells.size());
  const auto irradiance = [&](int cell) {
    const auto i = static_cast<size_t>(cell);
    return array.cell_light_W[i] / array.cell_area_m2[i];
  };
  for (const int cell : cells) {
    u.mean_W_m2 += irradiance(cell) / count;
    least = std::min(least, irradiance(cell));
  }
  if (!(u.mean_W_m2 > 0)) return u;
  for (const int cell : cells) {
    const double apart = irradiance(cell) / u.mean_W_m2 - 1.0;
    squares += apart * apart / count;
  }
  u.minimum_over_mean = least / u.mean_W_m2;
  u.variation = std::sqrt(squares);
  return u;
}

Table uniformity_table(const ArrayResult& array, const ArrayWiring& wiring) {
  Table table = Table::of("uniformity", "Uniformity of the light");
  const auto add = [&](const std::string& name, const std::vector<int>& cells) {
    const Uniformity u = uniformity(array, cells);
    table.row()
        .set("cells", name)
        .set("mean_W_m2", u.mean_W_m2)
        .set("minimum_over_mean", u.minimum_over_mean)
        .set("variation", u.variation);
  };
  std::vector<int> all(array.cell_light_W.size());
  std::iota(all.begin(), all.end(), 0);
  add("array", all);
  for (size_t s = 0; s < wiring.strings.size(); ++s) {
    std::vector<int> cells;
    wiring.strings[s].for_each_cell([&](int cell) { cells.push_back(cell); });
    add("string " + std::to_string(s + 1), cells);
  }
  return table;
}

double array_power_W(const ArrayDesign& design, const ArrayResult& array, double array_K,
                     double light_factor) {
  std::vector<double> light_A =
      warmed(design, array.cell_photocurrent_A, array_K, design.temperature_K);
  for (double& i : light_A) i *= light_factor;
  const double max_A = *std::ranges::max_element(light_A);
  const CellTables tables = cell_tables(design, array.cell_area_m2, max_A);
  return ArrayCurve(design.wiring, tables, light_A).maximum_power().power_W();
}

std::vector<ArraySensitivity> sensitivities(const ArrayDesign& design, const ArrayResult& array) {
  const double now_W = array_power_W(design, array, design.temperature_K, 1.0);
  std::vector<ArraySensitivity> all;
  const auto add = [&](const std::string& change, double light_factor,
                       const std::function<void(ArrayDesign&)>& apply) {
    ArrayDesign changed = design;
    apply(changed);
    const double power_W = array_power_W(changed, array, design.temperature_K, light_factor);
    all.push_back({change, power_W, now_W > 0 ? power_W / now_W - 1.0 : 0.0});
  };
  add("light or quantum efficiency +1 %", 1.01, [](ArrayDesign&) {});
  add("light -10 %", 0.9, [](ArrayDesign&) {});
  add("temperature +10 K", 1.0, [](ArrayDesign& d) { d.temperature_K += 10.0; });
  const auto add_of_cells = [&](const std::string& change,
                                const std::function<void(CellParameters&)>& apply) {
    add(change, 1.0, [&](ArrayDesign& d) {
      apply(d.cell.reference);
      for (CellOverride& one : d.overrides) apply(one.model.reference);
    });
  };
  add_of_cells("series resistance x 2", [](CellParameters& p) { p.series_ohm *= 2.0; });
  add_of_cells("shunt resistance / 2", [](CellParameters& p) { p.shunt_ohm /= 2.0; });
  add_of_cells("saturation currents x 2", [](CellParameters& p) {
    p.saturation_1_A *= 2.0;
    p.saturation_2_A *= 2.0;
  });
  return all;
}

std::vector<CellFigures> known_cell_figures(double irradiance_W_m2, double photon_V,
                                            double quantum_efficiency, double temperature_K) {
  std::vector<CellFigures> figures;
  for (const NamedCell& known : known_cells()) {
    // One quantum efficiency for all; cells of other semiconductors have other absorption edges.
    if (!known.name.starts_with("silicon")) continue;
    const double area_m2 = known.model.reference_area_m2;
    const CellCurve cell(parameters_at(known.model, area_m2, temperature_K));
    const double light_W = irradiance_W_m2 * area_m2;
    const double light_A = light_W * quantum_efficiency / photon_V;
    const double open_V = cell.open_circuit_V(light_A);
    const double power_W = cell.maximum_power(light_A).power_W();
    const double fill = power_W / (open_V * light_A);
    figures.push_back(
        {known.name, open_V, fill, quantum_efficiency * open_V * fill, power_W / light_W});
  }
  return figures;
}

}  // namespace photorque
