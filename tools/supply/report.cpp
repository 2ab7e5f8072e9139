#include "tools/supply/trade.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "tools/runs/attitude_run.h"

namespace photorque {
namespace {

// A figure that is both a column of the table and a quantity; `error`: the column of its error, or
// null.
struct OptionFigure {
  const char *name, *error;
  Estimate value;
};

std::vector<OptionFigure> figures_of(const SupplyOption& option, const SupplyTask& task) {
  const SupplyDisturbance worst = disturbance_of(option, task);
  const Estimate angle_deg_W{worst.angle_rad_W.value / degree_rad,
                             worst.angle_rad_W.standard_error / degree_rad};
  return {{"mass_kg", "mass_error_kg", option.mass_kg},
          {"source_W", "source_error_W", option.source_W},
          {"delivered_level_W", nullptr, option.curve.front().delivered_W},
          {"delivered_tilted_W", "delivered_tilted_error_W", option.curve.back().delivered_W},
          {"torque_N_m", "torque_error_N_m", worst.torque_N_m},
          {"torque_N_m_per_W", "torque_error_N_m_per_W", worst.torque_N_m_W},
          {"angle_deg_per_W", "angle_error_deg_per_W", angle_deg_W},
          {"alternating_N_m", nullptr, {worst.alternating_N_m, 0.0}}};
}

// Adds the table "supply" and the quantities.
void add_supplies(const SupplyTrade& trade, Product& product) {
  Table table = Table::of("supply", "Power supplies");
  for (const SupplyOption& option : trade.options) {
    Table::Row row = table.row().set("way", option.name);
    for (const auto& [name, error, value] : figures_of(option, trade.task)) {
      row.set(name, value.value);
      if (error != nullptr) row.set(error, value.standard_error);
      product.quantities.push_back({option.symbol + "_" + name, value});
    }
  }
  product.tables.push_back(std::move(table));
}

Table tilt_table(const SupplyTrade& trade) {
  Table table = Table::of("supply_by_tilt", "Every supply over the tilt");
  for (const SupplyOption& option : trade.options) {
    for (size_t t = 0; t < option.curve.size(); ++t) {
      const SupplyPoint& point = option.curve[t];
      table.row()
          .set("way", option.name)
          .set("tilt_deg", trade.task.tilt_rad[t] / degree_rad)
          .set("delivered_W", point.delivered_W.value)
          .set("delivered_error_W", point.delivered_W.standard_error)
          .set("torque_N_m", point.torque_N_m.value)
          .set("torque_error_N_m", point.torque_N_m.standard_error)
          .set("alternating_N_m", point.alternating_N_m.value);
    }
  }
  return table;
}

Table figures_of_options(const SupplyTrade& trade) {
  Table table = Table::of("supply_figures", "Figures of each supply");
  for (const SupplyOption& option : trade.options) {
    for (const auto& [name, estimate] : option.figures) {
      table.row()
          .set("way", option.name)
          .set("figure", name)
          .set("value", estimate.value)
          .set("error", estimate.standard_error);
    }
  }
  return table;
}

Table charge_table(const SupplyTrade& trade) {
  Table table = Table::of("battery_by_charge", "Torque of the battery's lithium at zero tilt");
  for (size_t i = 0; i < trade.charge_fraction.size(); ++i) {
    table.row()
        .set("charge_fraction", trade.charge_fraction[i])
        .set("torque_N_m", trade.battery_torque_N_m[i]);
  }
  return table;
}

// Smaller torques are not drawn, to limit the decades of the logarithmic axis.
constexpr double least_torque_N_m = 1e-13;
// At zero tilt the torque of light is zero; smaller values are the noise of the trace.
constexpr double level_torque_N_m = 1e-10;

Plot tilt_plot(const SupplyTrade& trade) {
  Plot plot{"supply_over_tilt", "Power to the load and disturbance torque over the tilt",
            "tilt [deg]", "delivered [W]"};
  Plot::Panel torque{"|torque| [N m]", {}, true};
  for (const SupplyOption& option : trade.options) {
    Plot::Curve delivered, pushes;
    delivered.label = pushes.label = option.name;
    // The curves of battery and cable coincide; the dashed one leaves the other visible.
    delivered.dashed = pushes.dashed = option.symbol == "cable";
    for (size_t t = 0; t < option.curve.size(); ++t) {
      const double tilt_deg = trade.task.tilt_rad[t] / degree_rad;
      const SupplyPoint& point = option.curve[t];
      delivered.x.push_back(tilt_deg);
      delivered.y.push_back(point.delivered_W.value);
      // A torque with zero mean, as of induction, is drawn with its standard error.
      const double size =
          std::max(std::abs(point.torque_N_m.value), point.torque_N_m.standard_error);
      if (size < least_torque_N_m || (t == 0 && size < level_torque_N_m)) continue;
      pushes.x.push_back(tilt_deg);
      pushes.y.push_back(size);
    }
    plot.curves.push_back(std::move(delivered));
    if (!pushes.x.empty()) torque.curves.push_back(std::move(pushes));
  }
  plot.below.push_back(std::move(torque));
  return plot;
}

Plot charge_plot(const SupplyTrade& trade) {
  Plot plot{"battery_torque_by_charge",
            "Torque of the battery's lithium by the charge drawn, at zero tilt",
            "charge drawn [% of the total]", "torque [N m]"};
  Plot::Curve curve;
  for (const double fraction : trade.charge_fraction) curve.x.push_back(100.0 * fraction);
  curve.y = trade.battery_torque_N_m;
  plot.curves.push_back(std::move(curve));
  return plot;
}

}  // namespace

Product supply_product(const SupplyTrade& trade) {
  Product product;
  add_supplies(trade, product);
  product.tables.insert(product.tables.end(), {tilt_table(trade), figures_of_options(trade),
                                               charge_table(trade), paper_supply_table(trade)});
  product.plots = {tilt_plot(trade), charge_plot(trade)};
  return product;
}

void print_supply(const Console& console, const Product& product, const SupplyTrade& trade) {
  const SupplyTask& task = trade.task;
  console.line(show(task.load_W) + " W for " + show(task.duration_s / 3600.0) + " h, tilts up to " +
               show(task.tilt_rad.back() / degree_rad) + " deg");
  console.heading(
      "Power supplies: largest torque over the tilts, and the rotation that it causes in this "
      "time");
  print_table(console, table_named(product, "supply"),
              {{"supply", "way"},
               {"on board [kg]", "mass_kg"},
               {"±", "mass_error_kg"},
               {"source [W]", "source_W"},
               {"±", "source_error_W"},
               {"at 0 deg [W]", "delivered_level_W"},
               {"at max tilt [W]", "delivered_tilted_W"},
               {"torque [N m]", "torque_N_m"},
               {"±", "torque_error_N_m"},
               {"per W [N m]", "torque_N_m_per_W"},
               {"per W [deg]", "angle_deg_per_W"},
               {"±", "angle_error_deg_per_W"},
               {"alternating [N m]", "alternating_N_m"}});
  for (const SupplyOption& option : trade.options) {
    for (const std::string& remark : option.remarks) {
      console.line("  " + option.name + ": " + remark);
    }
  }
  const Console details = console.details();
  details.heading("Section III.B of the paper compared with photorque");
  const Table& paper = table_named(product, "paper_supply");
  print_table(details, paper,
              {{"quantity", "quantity"}, {"paper", "published"}, {"photorque", "ours"}});
  print_reasons(details, paper);
}

}  // namespace photorque
