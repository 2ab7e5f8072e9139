#include "attitude/budget.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "attitude/run.h"
#include "core/constants.h"
#include "core/transform.h"

namespace photorque {
namespace {

constexpr double minute_s = 60.0, hour_s = 3600.0, day_s = 86400.0;

// The paper's figure for a kind of disturbance, by the name of the figure; empty if it has none.
std::string figure_of_kind(const std::string& kind) {
  if (kind == "stepper_quantization") return "stepper_torque_N_m";
  if (kind == "air_friction") return "lumped_drag_at_1_rpm_N_m";
  if (kind == "air_pressure_drag") return "cfd_drag_at_1_rpm_N_m";
  if (kind == "radiation_pressure") return "radiation_torque_at_30_deg_N_m";
  if (kind == "battery_discharge") return "battery_torque_N_m";
  return "";
}

std::vector<std::string> names_of(const std::vector<Disturbance>& disturbances) {
  std::map<std::string, int> total, so_far;
  for (const Disturbance& d : disturbances) ++total[d.kind];
  std::vector<std::string> names;
  for (const Disturbance& d : disturbances) {
    const int number = ++so_far[d.kind];
    names.push_back(total[d.kind] > 1 ? d.kind + "_" + std::to_string(number) : d.kind);
  }
  return names;
}

Quat lab_from_body(double tilt_rad, double heading_rad) {
  return lab_from_body_at(tilt_rad, heading_rad).rotation;
}

double read_charge_drawn_C(const Settings& settings, const Platform& platform) {
  if (!settings.has("state_of_charge")) {
    return settings.number_or("charge_drawn_Ah", 0.0, Range::not_negative());
  }
  const double state_of_charge = settings.number("state_of_charge", Range::fraction());
  if (state_of_charge < 1.0 && !platform.battery_capacity_C) {
    throw settings.error("state_of_charge", "no platform.battery_capacity_Ah",
                         "the battery's capacity beside its state of charge");
  }
  return (1.0 - state_of_charge) * platform.battery_capacity_C.value_or(0.0);
}

PlatformState read_state(const Settings& settings, const AttitudeModel& model) {
  const Quat attitude = lab_from_body(settings.number_or("tilt_deg", 0.0, {0.0, pi, false, false}),
                                      settings.number_or("heading_deg", 0.0));
  const Vec3 spin_lab_rad_s(0.0, 0.0, settings.number_or("spin_rpm", 0.0));
  const Vec3 rate_body_rad_s =
      attitude.conjugate() * spin_lab_rad_s + settings.vector3_or("rate_rad_s", Vec3::Zero());
  PlatformState state = Dynamics(model).initial_state(rate_body_rad_s);
  state.lab_from_body = attitude;
  state.time_s = settings.number_or("time_s", 0.0);
  state.charge_drawn_C = read_charge_drawn_C(settings, model.platform);
  return state;
}

std::vector<BearingDatasheet> read_catalogue(const Settings& settings) {
  std::vector<BearingDatasheet> catalogue;
  for (const Settings& s : settings.tables("bearing")) {
    BearingDatasheet b;
    b.name = s.text("name");
    b.socket = {s.number("radius_m", Range::positive()),
                s.number("half_angle_deg", {0.0, pi / 2, true, false}),
                s.number("gap_m", Range::positive())};
    b.inlet_Pa = s.number("inlet_Pa", Range::positive());
    b.load_N = s.number("load_N", Range::positive());
    b.drag_N_m = s.number_or("drag_N_m", 0.0, Range::not_negative());
    b.drag_rate_rad_s = s.number_or("drag_rate_rpm", b.drag_rate_rad_s, Range::positive());
    catalogue.push_back(b);
  }
  return catalogue;
}

Table budget_table(const Budget& budget) {
  std::map<std::string, PaperFigure> paper;
  for (const PaperFigure& figure : paper_figures()) paper[figure.quantity] = figure;
  Table::Column name{"disturbance", {}, {}}, figure_name{"paper_figure", {}, {}};
  std::array<Table::Column, 3> torque;
  for (int k = 0; k < 3; ++k) torque[k].name = std::string("torque_") + "xyz"[k] + "_N_m";
  Table::Column size{"torque_N_m", {}, {}}, share{"share_of_sum", {}, {}},
      minute{"angle_1_min_deg", {}, {}}, hour{"angle_1_h_deg", {}, {}},
      day{"angle_1_day_deg", {}, {}}, published{"paper_N_m", {}, {}}, ratio{"ratio", {}, {}};
  double sum_N_m = 0.0;
  for (const BudgetEntry& e : budget.entries) sum_N_m += e.torque_body_N_m.norm();
  for (const BudgetEntry& e : budget.entries) {
    const double torque_N_m = e.torque_body_N_m.norm();
    const std::string figure = figure_of_kind(e.kind);
    name.texts.push_back(e.name);
    figure_name.texts.push_back(figure.empty() ? "-" : figure);
    for (int k = 0; k < 3; ++k) torque[k].values.push_back(e.torque_body_N_m[k]);
    size.values.push_back(torque_N_m);
    share.values.push_back(sum_N_m > 0.0 ? torque_N_m / sum_N_m : 0.0);
    minute.values.push_back(e.angle_after_minute_rad / degree_rad);
    hour.values.push_back(e.angle_after_hour_rad / degree_rad);
    day.values.push_back(e.angle_after_day_rad / degree_rad);
    const double paper_N_m = figure.empty() ? std::nan("") : paper.at(figure).published;
    published.values.push_back(paper_N_m);
    ratio.values.push_back(torque_N_m / paper_N_m);
  }
  return {"budget",
          "Disturbance torques at the state, largest first",
          {name, figure_name, torque[0], torque[1], torque[2], size, share, minute, hour, day,
           published, ratio}};
}

Plot tilt_plot(const Budget& budget) {
  Plot plot;
  plot.name = "torque_by_tilt";
  plot.title = "Disturbance torques by tilt";
  plot.x_label = "tilt [deg]";
  plot.y_label = "torque [N m]";
  plot.y_log = true;
  for (const std::string& name : names_of(budget.model.disturbances)) {
    plot.curves.push_back({name, {}, {}, {}, false});
  }
  const double limit_rad = budget.model.platform.tilt_limit_rad.value_or(30.0 * degree_rad);
  const double heading_rad = std::atan2((budget.state.lab_from_body * Vec3::UnitZ()).y(),
                                        (budget.state.lab_from_body * Vec3::UnitZ()).x());
  const Vec3 rate_lab_rad_s = budget.state.lab_from_body * budget.state.rate_body_rad_s;
  constexpr int steps = 60;
  for (int i = 0; i <= steps; ++i) {
    const double tilt_rad = limit_rad * i / steps;
    PlatformState state = budget.state;
    state.lab_from_body = lab_from_body(tilt_rad, heading_rad);
    state.rate_body_rad_s = state.lab_from_body.conjugate() * rate_lab_rad_s;
    const std::vector<Vec3> torques = disturbance_torques_body_N_m(budget.model, state);
    for (size_t d = 0; d < torques.size(); ++d) {
      const double torque_N_m = torques[d].norm();
      if (!(torque_N_m > 0.0)) continue;  // nothing to draw on a logarithmic axis
      plot.curves[d].x.push_back(tilt_rad / degree_rad);
      plot.curves[d].y.push_back(torque_N_m);
    }
  }
  std::erase_if(plot.curves, [](const Plot::Curve& curve) { return curve.x.empty(); });
  return plot;
}

}  // namespace

Budget make_budget(AttitudeModel model, const PlatformState& state) {
  Budget budget{std::move(model), state, {}, {}};
  const std::vector<Vec3> torques = disturbance_torques_body_N_m(budget.model, state);
  const std::vector<std::string> names = names_of(budget.model.disturbances);
  const Mat3 inverse_inertia = budget.model.platform.inertia_kg_m2.inverse();
  for (size_t d = 0; d < torques.size(); ++d) {
    if (budget.model.disturbances[d].stage == Stage::measurement) continue;
    const double acceleration_rad_s2 = (inverse_inertia * torques[d]).norm();
    const auto angle_after = [&](double t_s) { return 0.5 * acceleration_rad_s2 * t_s * t_s; };
    budget.entries.push_back({budget.model.disturbances[d].kind, names[d], torques[d],
                              angle_after(minute_s), angle_after(hour_s), angle_after(day_s)});
  }
  std::stable_sort(budget.entries.begin(), budget.entries.end(),
                   [](const BudgetEntry& a, const BudgetEntry& b) {
                     return a.torque_body_N_m.norm() > b.torque_body_N_m.norm();
                   });
  return budget;
}

Budget read_budget(const Settings& root) {
  AttitudeModel model = read_attitude_model(root).model;
  if (!root.has("budget")) {
    const PlatformState upright = Dynamics(model).initial_state();
    return make_budget(std::move(model), upright);
  }
  const Settings settings = root.table("budget");
  const PlatformState state = read_state(settings, model);
  Budget budget = make_budget(std::move(model), state);
  budget.catalogue = read_catalogue(settings);
  settings.finish();
  return budget;
}

Product budget_product(const Budget& budget) {
  Product product = paper_product();
  product.tables.insert(product.tables.begin(), budget_table(budget));
  product.plots.insert(product.plots.begin(), tilt_plot(budget));
  Vec3 total_N_m = Vec3::Zero();
  for (const BudgetEntry& e : budget.entries) total_N_m += e.torque_body_N_m;
  product.quantities.push_back({"total_torque_N_m", {total_N_m.norm(), 0.0}});
  if (!budget.catalogue.empty()) {
    const BearingComparison c =
        compare_bearings(budget.catalogue, budget.model.environment.air_pressure_Pa,
                         budget.model.environment.air_viscosity_Pa_s);
    product.quantities.push_back({"bearing_load_mean_error", {c.load_error, 0.0}});
    product.quantities.push_back(
        {"bearing_load_mean_error_as_published", {c.load_error_as_published, 0.0}});
    product.quantities.push_back({"bearing_drag_mean_ratio", {c.drag_ratio, 0.0}});
  }
  return product;
}

}  // namespace photorque
