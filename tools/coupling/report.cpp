#include "tools/coupling/report.h"

#include <algorithm>
#include <cmath>

#include "attitude/propagation/time_history.h"
#include "core/constants.h"

namespace photorque {
namespace {

struct EnergyRow {
  std::string name;
  double energy_J;
  bool is_detail = false;  // printed only with --verbose
};

// The rows of the energy balance.
std::vector<EnergyRow> energy_rows(const CoupledRun& run) {
  const PowerSupply& supply = *run.supply();
  const SupplyEnergies& e = supply.energies();
  std::vector<EnergyRow> rows;
  if (run.emitted_J() > 0.0) rows.push_back({"light emitted by lamps", run.emitted_J()});
  rows.push_back({"light on the cells", e.on_cells.value()});
  if (supply.design().array.heat) {
    rows.push_back({"reflected by the cells", e.reflected.value(), true});
    rows.push_back({"heat given off by the cells", e.given_off.value(), true});
  }
  rows.push_back({"electric, from the array", e.array.value()});
  rows.push_back({"electric, at the array's best point", e.best.value(), true});
  rows.push_back({"lost in the converter", e.converter.value(), true});
  rows.push_back({"load", e.load.value()});
  if (supply.design().battery) {
    rows.push_back({"unserved load", e.unserved.value()});
    rows.push_back({"into the battery", e.into_battery.value(), true});
    rows.push_back({"out of the battery", e.out_of_battery.value()});
    rows.push_back({"lost in the battery", e.battery_loss.value(), true});
  }
  return rows;
}

Plot together(const Table& power, const Table& history) {
  const std::vector<double>& t = power.column("t_s").values;
  const std::vector<double>& moved = history.column("t_s").values;
  Plot plot{"power_and_attitude", "Power, charge, attitude and torque", "time [s]", "power [W]"};
  plot.curves = {thinned_curve(t, power.column("load_power_W").values),
                 thinned_curve(t, power.column("array_power_W").values)};
  plot.curves[0].label = "load served";
  plot.curves[0].colour = Plot::Colour::grey;
  plot.curves[1].label = "array";
  const auto add = [&](const char* label, const std::vector<double>& x,
                       const std::vector<double>& y) {
    plot.below.push_back({label, {thinned_curve(x, y)}});
  };
  if (const Table::Column* charge = power.find("battery_charge_Wh")) {
    add("battery [Wh]", t, charge->values);
  }
  add("cells [K]", t, power.column("cell_temperature_K").values);
  add("tilt [deg]", moved, history.column("tilt_deg").values);
  if (history.find("torque_radiation_pressure_x_N_m") != nullptr) {
    add("light [N m]", moved, torque_sizes(history, "torque_radiation_pressure"));
  }
  return plot;
}

Table power_table(const CoupledRun& run, size_t max_rows) {
  const bool battery = run.supply()->design().battery.has_value();
  Table table = Table::of("power", "Light, array and battery: means since the row before");
  const std::vector<PowerRow>& rows = run.rows();
  const size_t stride = std::max<size_t>(1, (rows.size() + max_rows - 1) / max_rows);
  for (size_t first = 0; first < rows.size(); first += stride) {
    const size_t last = std::min(first + stride, rows.size()) - 1;
    PowerRow mean = rows[last];
    const auto average = [&](double PowerRow::*of) {
      double sum = 0.0;
      for (size_t i = first; i <= last; ++i) sum += rows[i].*of;
      mean.*of = sum / static_cast<double>(last - first + 1);
    };
    for (const auto of :
         {&PowerRow::light_W, &PowerRow::best_W, &PowerRow::array_W, &PowerRow::load_W,
          &PowerRow::voltage_V, &PowerRow::battery_current_A, &PowerRow::output}) {
      average(of);
    }
    Table::Row row = table.row();
    row.set("t_s", mean.time_s).set("light_on_cells_W", mean.light_W);
    row.set("lamp_output", mean.output).set("best_power_W", mean.best_W);
    row.set("array_power_W", mean.array_W).set("array_voltage_V", mean.voltage_V);
    row.set("load_power_W", mean.load_W).set("cell_temperature_K", mean.temperature_K);
    if (!battery) continue;
    row.set("battery_current_A", mean.battery_current_A);
    row.set("battery_charge_Wh", mean.stored_J / 3600.0);
  }
  return table;
}

double quantile(std::vector<double> sorted, double q) {
  const double at = q * static_cast<double>(sorted.size() - 1);
  const auto i = static_cast<size_t>(at);
  const size_t next = std::min(i + 1, sorted.size() - 1);
  return std::lerp(sorted[i], sorted[next], at - static_cast<double>(i));
}

}  // namespace

Product table_product(const RotationTable& table) {
  Product product;
  Table errors =
      Table::of("light_table", "The table of light over attitude, at independent attitudes");
  const RotationTableError& error = table.error();
  for (size_t g = 0; g < error.scale.size(); ++g) {
    errors.row()
        .set("quantity", LightModel::quantities[g])
        .set("unit", LightModel::units[g])
        .set("largest", error.scale[g])
        .set("rms_error", error.rms[g])
        .set("max_error", error.max[g])
        .set("noise", error.noise[g]);
  }
  product.tables.push_back(std::move(errors));
  product.quantities = {
      {"light_table_attitudes", {static_cast<double>(table.samples() * table.twists()), 0.0}},
      {"light_table_torque_error_N_m", {error.max[0], 0.0}}};
  return product;
}

void print_light_table(const Console& console, const RotationTable& table) {
  const RotationTableError& error = table.error();
  console.line(table.twists() == 1 ? "  equal at every yaw, by tracing"
                                   : "  depends on the yaw: " + std::to_string(table.twists()) +
                                         " values over " + show(360.0 / table.fold()) + " deg");
  console.line("  " + std::to_string(table.leaves()) +
               (table.leaves() == 1 ? " patch" : " patches") + " over tilt and heading; at " +
               std::to_string(error.points) + " independent attitudes differ by at most");
  for (size_t g = 0; g < error.scale.size(); ++g) {
    if (!(error.scale[g] > 0.0)) continue;
    console.line("    " + padded(LightModel::quantities[g], 16) + show(error.max[g]) + " " +
                 LightModel::units[g] + "  (" + show(100.0 * error.max[g] / error.scale[g]) +
                 " % of the largest; noise " + show(100.0 * error.noise[g] / error.scale[g]) +
                 " %)");
  }
}

std::optional<std::string> hot_cells(const CoupledRun& run) {
  if (run.rows().empty()) return {};
  const auto hottest = std::ranges::max_element(run.rows(), {}, &PowerRow::temperature_K);
  return above_rated(run.supply()->design().array, hottest->temperature_K);
}

Product power_product(const CoupledRun& run, const Product& history, size_t max_rows) {
  Product product;
  if (run.rows().empty()) return product;
  const Table power = power_table(run, max_rows);
  const Table* motion = find_table(history, "time_history");
  if (motion != nullptr) product.plots.push_back(together(power, *motion));
  product.tables.push_back(power);
  Table energies = Table::of("energy_balance", "Energy balance");
  for (const EnergyRow& row : energy_rows(run)) {
    energies.row()
        .set("what", row.name)
        .set("energy_J", row.energy_J)
        .set("energy_Wh", row.energy_J / 3600.0);
  }
  product.tables.push_back(std::move(energies));
  const SupplyEnergies& e = run.supply()->energies();
  const SupplyClosure closure = run.supply()->closure();
  const double duration_s = run.rows().back().time_s - power.column("t_s").values.front();
  product.quantities = {
      {"array_energy_J", {e.array.value(), 0.0}},
      {"load_energy_J", {e.load.value(), 0.0}},
      {"load_unserved_J", {e.unserved.value(), 0.0}},
      {"array_energy_Wh", {e.array.value() / 3600.0, 0.0}},
      {"load_energy_Wh", {e.load.value() / 3600.0, 0.0}},
      {"load_unserved_Wh", {e.unserved.value() / 3600.0, 0.0}},
      {"energy_closure", {closure.largest(), 0.0}},
      {"energy_closure_cells", {closure.cells, 0.0}},
      {"energy_closure_bus", {closure.bus, 0.0}},
      {"energy_closure_battery", {closure.battery, 0.0}},
      {"cell_temperature_K", {run.supply()->temperature_K(), 0.0}},
      {"charge_correction_C", {run.max_correction_C(), 0.0}},
  };
  if (e.best.value() > 0.0) {
    product.quantities.push_back({"array_use", {e.array.value() / e.best.value(), 0.0}});
  }
  if (duration_s > 0.0) {
    double sum = 0.0;
    for (const PowerRow& row : run.rows()) sum += row.array_W;
    product.quantities.push_back(
        {"mean_array_power_W", {sum / static_cast<double>(run.rows().size()), 0.0}});
  }
  if (run.supply()->design().battery) {
    const auto least = std::ranges::min_element(run.rows(), {}, &PowerRow::stored_J);
    product.quantities.insert(
        product.quantities.end(),
        {{"battery_left_J", {run.supply()->stored_J(), 0.0}},
         {"battery_left_Wh", {run.supply()->stored_J() / 3600.0, 0.0}},
         {"least_battery_charge_J", {least->stored_J, 0.0}},
         {"least_battery_charge_Wh", {least->stored_J / 3600.0, 0.0}},
         {"least_battery_charge_fraction",
          {least->stored_J / run.supply()->design().battery->capacity_J, 0.0}},
         {"least_battery_charge_time_s", {least->time_s, 0.0}}});
  }
  return product;
}

void print_power(const Console& console, const CoupledRun& run) {
  if (run.continuation().count > 0) {
    const ContinuationError& error = run.continuation();
    console.heading("Light, traced at every exchange");
    console.line("  " + std::to_string(run.traces()) +
                 " attitudes; the torque extrapolated from the "
                 "last three differed from the next by at most " +
                 show(error.max_N_m) + " N m, rms " +
                 show(std::sqrt(error.sum_squares / static_cast<double>(error.count))) + " N m");
  }
  if (!run.supply()) return;
  const ArrayDesign& array = run.supply()->design().array;
  console.heading("Energy");
  console.line("  " + padded("cells at the end", 38) +
               show_temperature(run.supply()->temperature_K()) + ", " +
               (array.heat ? array.heat->in_words() : origin_of_temperature(array)));
  for (const EnergyRow& row : energy_rows(run)) {
    (row.is_detail ? console.details() : console)
        .line("  " + padded(row.name, 38) + show(row.energy_J / 3600.0) + " Wh");
  }
  if (run.supply()->design().battery) {
    console.line("  " + padded("left in the battery", 38) +
                 show(run.supply()->stored_J() / 3600.0) + " Wh");
    const auto least = std::ranges::min_element(run.rows(), {}, &PowerRow::stored_J);
    if (least != run.rows().end()) {
      console.line("  " + padded("least charge", 38) + show(least->stored_J / 3600.0) + " Wh at " +
                   show_duration(least->time_s));
    }
  }
  const SupplyClosure closure = run.supply()->closure();
  console.details().line("  balance closed to " + show(closure.largest()) + " (cells " +
                         show(closure.cells) + ", converter and load " + show(closure.bus) +
                         ", battery " + show(closure.battery) + ")");
}

Product pointing_product(const std::vector<PlatformState>& states) {
  Product product;
  if (states.size() < 2) return product;
  const auto axis = [](const PlatformState& state) -> Vec3 {
    return state.lab_from_body * Vec3::UnitZ();
  };
  Vec3 sum = Vec3::Zero();
  for (const PlatformState& state : states) sum += axis(state);
  const Vec3 mean = sum.norm() > 0.0 ? Vec3(sum.normalized()) : Vec3::UnitZ();
  std::vector<double> off;
  double squares = 0.0;
  for (const PlatformState& state : states) {
    const Vec3 z = axis(state);
    const double angle = std::atan2(z.cross(mean).norm(), z.dot(mean));
    off.push_back(angle / degree_rad);
    squares += angle * angle;
  }
  std::ranges::sort(off);
  const double rms = std::sqrt(squares / static_cast<double>(states.size())) / degree_rad;
  product.quantities = {{"pointing_rms_deg", {rms, 0.0}},
                        {"pointing_95_percent_deg", {quantile(off, 0.95), 0.0}},
                        {"pointing_99_7_percent_deg", {quantile(off, 0.997), 0.0}},
                        {"pointing_max_deg", {off.back(), 0.0}}};
  Table stability = Table::of("pointing_stability", "Rotation of the z axis within a window");
  const double step_s = states[1].time_s - states[0].time_s;
  for (const double window_s : {1.0, 10.0, 100.0, 1000.0}) {
    const auto rows = static_cast<size_t>(std::llround(window_s / step_s));
    if (rows < 1 || std::abs(static_cast<double>(rows) * step_s - window_s) > 1e-6 * window_s ||
        4 * rows > states.size()) {
      continue;
    }
    std::vector<double> turns;
    double turn_squares = 0.0;
    for (size_t i = 0; i + rows < states.size(); ++i) {
      const Vec3 a = axis(states[i]), b = axis(states[i + rows]);
      const double turn = std::atan2(a.cross(b).norm(), a.dot(b)) / degree_rad;
      turns.push_back(turn);
      turn_squares += turn * turn;
    }
    std::ranges::sort(turns);
    stability.row()
        .set("window_s", window_s)
        .set("rms_deg", std::sqrt(turn_squares / static_cast<double>(turns.size())))
        .set("percent_95_deg", quantile(turns, 0.95))
        .set("max_deg", turns.back());
  }
  if (!stability.columns.empty()) product.tables.push_back(std::move(stability));
  return product;
}

void print_pointing(const Console& console, const Product& pointing) {
  if (pointing.quantities.empty()) return;
  const auto figure = [&](size_t i) {
    return show_brief(pointing.quantities[i].estimate.value) + " deg";
  };
  console.heading("Pointing of body z about its mean direction: rms " + figure(0) +
                  ", 95 % within " + figure(1) + ", 99.7 % within " + figure(2) + ", largest " +
                  figure(3));
}

}  // namespace photorque
