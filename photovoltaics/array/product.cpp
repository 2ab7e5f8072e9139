// The results of an array as tables, curves and maps.
#include <algorithm>

#include "core/text/format.h"
#include "photovoltaics/array/array.h"

namespace photorque {
namespace {

Map cell_map(const ArrayResult& result, const std::string& name, const std::string& title,
             const std::string& unit, std::vector<double> values, bool signed_values = false) {
  Map map{name, title, unit, result.columns, result.rows};
  map.x_high = result.columns;
  map.y_high = result.rows;
  map.x_label = "cell along u";
  map.y_label = "cell along v";
  map.signed_values = signed_values && *std::ranges::min_element(values) < 0.0;
  map.value = std::move(values);
  return map;
}

std::vector<double> products(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> all;
  for (size_t i = 0; i < a.size(); ++i) all.push_back(a[i] * b[i]);
  return all;
}

Table point_table(const std::string& name, const std::string& title,
                  const std::vector<ArrayPoint>& points) {
  Table table = Table::of(name, title, {"voltage_V", "current_A", "power_W"});
  for (const ArrayPoint& p : points) {
    table.row()
        .set("voltage_V", p.voltage_V)
        .set("current_A", p.current_A)
        .set("power_W", p.power_W());
  }
  return table;
}

Table cell_table(const ArrayResult& result) {
  Table table = Table::of("cells", "Cells at the maximum power point");
  std::vector<double> index, irradiance;
  for (size_t i = 0; i < result.cell_light_W.size(); ++i) {
    index.push_back(static_cast<double>(i));
    irradiance.push_back(result.cell_light_W[i] / result.cell_area_m2[i]);
  }
  table.add("cell", index)
      .add("irradiance_W_m2", irradiance)
      .add("photocurrent_A", result.cell_photocurrent_A)
      .add("voltage_V", result.cells.voltages_V)
      .add("current_A", result.cells.currents_A)
      .add("power_W", products(result.cells.voltages_V, result.cells.currents_A));
  if (result.cell_centre_m.empty()) return table;
  std::vector<double> u_m, v_m;
  for (const Vec2& centre : result.cell_centre_m) {
    u_m.push_back(centre.x());
    v_m.push_back(centre.y());
  }
  return table.add("centre_u_m", u_m).add("centre_v_m", v_m);
}

void add_plots(const ArrayResult& result, const Table& iv, Product& product) {
  const auto& v = iv.column("voltage_V").values;
  Plot current{"iv_curve", "Current of the array", "voltage [V]", "current [A]"};
  current.curves.push_back({"array", v, iv.column("current_A").values});
  current.curves.push_back({"maximum, " + readable_number(result.power_W.value) + " W",
                            {result.voltage_V.value},
                            {result.current_A.value},
                            {},
                            true});
  Plot power{"pv_curve", "Power of the array", "voltage [V]", "power [W]"};
  power.curves.push_back({"array", v, iv.column("power_W").values});
  Plot::Curve peaks{"local maxima", {}, {}, {}, true};
  for (const ArrayPoint& p : result.maxima) {
    peaks.x.push_back(p.voltage_V);
    peaks.y.push_back(p.power_W());
  }
  power.curves.push_back(peaks);
  product.plots.push_back(current);
  product.plots.push_back(power);
}

}  // namespace

Product array_product(const ArrayResult& result) {
  Product product;
  product.quantities = {
      {"array_power_W", result.power_W},
      {"array_voltage_V", result.voltage_V},
      {"array_current_A", result.current_A},
      {"power_on_cells_W", result.power_on_cells_W},
      {"area_of_cells_m2", {result.area_of_cells_m2, 0.0}},
      {"cell_temperature_K", result.temperature_K},
      {"array_power_slope_W_K", {result.power_per_K_W, 0.0}},
      {"array_efficiency", result.efficiency},
      {"power_of_cells_alone_W", result.sum_of_cells_W},
      {"efficiency_of_cells_alone", result.efficiency_of_cells},
      {"mismatch_loss", result.mismatch_loss},
      {"short_circuit_current_A", {result.curve.front().current_A, 0.0}},
      {"open_circuit_voltage_V", {result.curve.back().voltage_V, 0.0}},
      {"local_maxima", {static_cast<double>(result.maxima.size()), 0.0}},
  };
  product.tables = {point_table("iv", "Current and power over voltage", result.curve),
                    point_table("maxima", "Local maxima of the power", result.maxima),
                    cell_table(result)};
  add_plots(result, product.tables[0], product);
  if (result.entry_known) {
    product.quantities.push_back({"power_entering_cells_W", result.power_entering_W});
  }
  // Cells at arbitrary places cannot be drawn in columns and rows.
  if (!result.cell_centre_m.empty() && result.rows == 1 && result.columns > 1) return product;
  const auto& cells = product.tables[2].columns;
  product.maps = {
      cell_map(result, "cell_irradiance", "Irradiance on the cells", "W/m²", cells[1].values),
      cell_map(result, "cell_photocurrent", "Photocurrent of the cells", "A", cells[2].values),
      cell_map(result, "cell_voltage", "Voltage of the cells at the maximum power point", "V",
               cells[3].values, true),
      cell_map(result, "cell_power", "Power of the cells at the maximum power point", "W",
               cells[5].values, true)};
  return product;
}

}  // namespace photorque
