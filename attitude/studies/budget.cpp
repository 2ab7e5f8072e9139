#include "attitude/studies/budget.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "attitude/disturbances/kind.h"
#include "attitude/propagation/run.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/settings/typed_keys.h"
#include "core/text/parse.h"
#include "core/transform.h"

namespace photorque {
namespace {

namespace budget_key {
constexpr NumberKey source_to_cell("source_to_cell", Range::fraction(),
                                   "light on the cells divided by the emitted light",
                                   {.usually = "the paper's"});
constexpr NumberKey conversion("conversion", Range::fraction(),
                               "electric power divided by the light on the cells",
                               {.usually = "the paper's"});
constexpr NumberKey power("power_W", Range::positive(), "power of the array at zero tilt",
                          {.usually = "the paper's"});
constexpr NumberKey power_at_30("power_at_30_deg_W", Range::positive(),
                                "power of the array at a tilt of 30 deg",
                                {.usually = "the paper's"});
constexpr Vec3Key torque_at_30("torque_at_30_deg_N_m",
                               "torque of the light at a tilt of 30 deg, body axes",
                               {.usually = "the paper's"});
constexpr TableKey light("light", "results of `power`, compared with the paper's");
constexpr TextKey name("name", "name of the bearing");
constexpr NumberKey radius("radius_m", Range::positive(), "radius of the ball");
constexpr NumberKey half_angle("half_angle_deg", {0.0, 0.5 * pi, true, false},
                               "polar angle of the socket's rim");
constexpr NumberKey gap("gap_m", Range::positive(), "thickness of the air film at the rated load");
constexpr NumberKey inlet("inlet_Pa", Range::positive(), "absolute pressure of the air supply");
constexpr NumberKey load("load_N", Range::positive(), "rated load");
constexpr NumberKey drag("drag_N_m", 0.0, Range::not_negative(),
                         "drag torque in the catalogue; 0: not given");
constexpr NumberKey drag_rate("drag_rate_rpm", pi, Range::positive(),  // 30 rpm
                              "rate at which the drag was measured");
constexpr TablesKey bearing("bearing", "a bearing of a catalogue, compared with the paper's model");
constexpr NumberKey tilt("tilt_deg", 0.0, {0.0, pi, false, false}, "tilt of the platform");
constexpr NumberKey heading("heading_deg", 0.0, {}, "azimuth of the tilt direction");
constexpr NumberKey spin("spin_rpm", 0.0, {}, "rate about the vertical of the lab");
constexpr Vec3Key rate("rate_rad_s", {0.0, 0.0, 0.0},
                       "angular rate, body axes, in addition to `spin_rpm`");
constexpr NumberKey state_of_charge(
    "state_of_charge", Range::fraction(),
    "state of charge of the battery; below 1 needs `platform.battery_capacity_Ah`; *or*",
    {.usually = "1"});
constexpr NumberKey charge_drawn("charge_drawn_Ah", 0.0, Range::not_negative(),
                                 "charge drawn since the battery was full");
constexpr NumberKey time("time_s", 0.0, {},
                         "time at which torques that depend on time are evaluated");
constexpr TableKey budget("budget", "the state at which torques are compared");
}  // namespace budget_key

constexpr double minute_s = 60.0, hour_s = 3600.0, day_s = 86400.0;

// The traits in the file of the kind. A disturbance without a kind has neither a figure nor a
// reason against ranking.
BudgetTraits traits_of(const std::string& kind) {
  const DisturbanceKind* known = find_kind(kind);
  return known == nullptr ? BudgetTraits{} : known->budget;
}

bool is_ranked(const Disturbance& disturbance) {
  return traits_of(disturbance.kind).reason_against.empty();
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

double read_charge_drawn_C(const Settings& settings, const Platform& platform) {
  if (!settings.has(budget_key::state_of_charge)) {
    const double drawn_C = settings.get(budget_key::charge_drawn);
    if (platform.battery_capacity_C && drawn_C > *platform.battery_capacity_C) {
      throw settings.error(budget_key::charge_drawn, shortest(drawn_C / 3600.0),
                           "no more than platform.battery_capacity_Ah");
    }
    return drawn_C;
  }
  if (settings.has(budget_key::charge_drawn)) {
    throw settings.error(budget_key::charge_drawn, "state_of_charge too", "one of the two");
  }
  const double state_of_charge = settings.get(budget_key::state_of_charge);
  if (state_of_charge < 1.0 && !platform.battery_capacity_C) {
    throw settings.error(budget_key::state_of_charge, "no platform.battery_capacity_Ah",
                         "the battery's capacity beside its state of charge");
  }
  return (1.0 - state_of_charge) * platform.battery_capacity_C.value_or(0.0);
}

PlatformState read_state(const Settings& settings, const AttitudeModel& model) {
  const Quat attitude =
      lab_from_body_at(settings.get(budget_key::tilt), settings.get(budget_key::heading)).rotation;
  const Vec3 spin_lab_rad_s(0.0, 0.0, settings.get(budget_key::spin));
  const Vec3 rate_body_rad_s =
      attitude.conjugate() * spin_lab_rad_s + settings.get(budget_key::rate);
  PlatformState state = Dynamics(model).initial_state(rate_body_rad_s);
  state.lab_from_body = attitude;
  state.time_s = settings.get(budget_key::time);
  state.charge_drawn_C = read_charge_drawn_C(settings, model.platform);
  return state;
}

std::vector<BearingDatasheet> read_catalogue(const Settings& settings) {
  std::vector<BearingDatasheet> catalogue;
  for (const Settings& s : settings.get(budget_key::bearing)) {
    BearingDatasheet b;
    b.name = s.get(budget_key::name);
    b.socket = {s.get(budget_key::radius), s.get(budget_key::half_angle), s.get(budget_key::gap)};
    b.inlet_Pa = s.get(budget_key::inlet);
    b.load_N = s.get(budget_key::load);
    b.drag_N_m = s.get(budget_key::drag);
    b.drag_rate_rad_s = s.get(budget_key::drag_rate);
    catalogue.push_back(b);
  }
  return catalogue;
}

// Torques of one disturbance within a second.
struct Acting {
  Vec3 largest_body_N_m = Vec3::Zero();
  Vec3 mean_body_N_m = Vec3::Zero();
};

Vec3 acceleration_rad_s2(const Dynamics::Instants& now) {
  constexpr size_t rate = component::rate;
  return {now.rates[rate][0], now.rates[rate + 1][0], now.rates[rate + 2][0]};
}

// A disturbance that changes the conditions of others (gravity, field, command, inertia) exerts no
// torque. Its effect is I times the difference of the accelerations with it and without it.
Vec3 torque_by_conditions_body_N_m(const AttitudeModel& model, size_t d,
                                   const Dynamics::Instants& with, const PlatformState& state) {
  if (!model.disturbances[d].states.empty()) return Vec3::Zero();
  AttitudeModel without = model;
  without.disturbances.erase(without.disturbances.begin() + static_cast<std::ptrdiff_t>(d));
  const Vec3 rest_rad_s2 = acceleration_rad_s2(Dynamics(std::move(without)).at(state));
  return model.platform.inertia_kg_m2 * (acceleration_rad_s2(with) - rest_rad_s2);
}

// The torques of all disturbances within the second after `state`, at constant attitude and rate. A
// vibration has its amplitude, a steady torque its value.
std::vector<Acting> acting_within_a_second(const AttitudeModel& model, const PlatformState& state) {
  // A prime number, so that only multiples of it are aliased among whole frequencies.
  constexpr int instants = 101;
  const Dynamics dynamics(model);
  std::vector<Acting> all(model.disturbances.size());
  for (int i = 0; i < instants; ++i) {
    PlatformState then = state;
    then.time_s += static_cast<double>(i) / instants;
    const Dynamics::Instants now = dynamics.at(then);
    for (size_t d = 0; d < all.size(); ++d) {
      // A condition is evaluated once: its changes within a second are not considered.
      if (model.disturbances[d].stage == Stage::conditions) {
        if (i > 0) continue;
        const Vec3 torque_N_m = torque_by_conditions_body_N_m(model, d, now, then);
        all[d] = {torque_N_m, torque_N_m};
        continue;
      }
      const Vec3 torque_N_m = lane_of(now.torque_body_N_m[d], 0);
      all[d].mean_body_N_m += torque_N_m / instants;
      if (!(torque_N_m.norm() <= all[d].largest_body_N_m.norm())) {
        all[d].largest_body_N_m = torque_N_m;
      }
    }
  }
  double largest_N_m = 0.0;
  for (const Acting& one : all) largest_N_m = std::max(largest_N_m, one.largest_body_N_m.norm());
  constexpr double rounding = 1e-15;
  for (Acting& one : all) {
    if (one.largest_body_N_m.norm() < rounding * largest_N_m) one = {};
  }
  return all;
}

// Reads the parts a second time, because a disturbance contains only their coefficient.
std::vector<AirPart> read_own_air_parts(const Settings& root) {
  std::vector<AirPart> all;
  if (!root.has("disturbance")) return all;
  SettingsNode holder;
  holder.value = SettingsNode::Table{{"disturbance", root.raw("disturbance")}};
  const Settings own(std::move(holder));
  for (const Settings& disturbance : own.tables("disturbance")) {
    if (!disturbance.has("part")) continue;
    const std::vector<AirPart> parts = read_air_parts(disturbance.tables("part"));
    all.insert(all.end(), parts.begin(), parts.end());
  }
  return all;
}

PaperLight read_light(const Settings& settings) {
  PaperLight light;
  if (!settings.has(budget_key::light)) return light;
  const Settings s = settings.get(budget_key::light);
  light.source_to_cell = s.get_or(budget_key::source_to_cell, light.source_to_cell);
  light.conversion = s.get_or(budget_key::conversion, light.conversion);
  light.power_W = s.get_or(budget_key::power, light.power_W);
  light.power_at_30_deg_W = s.get_or(budget_key::power_at_30, light.power_at_30_deg_W);
  light.torque_at_30_deg_N_m = s.get_or(budget_key::torque_at_30, light.torque_at_30_deg_N_m);
  return light;
}

Table budget_table(const Budget& budget) {
  std::map<std::string, PaperFigure> paper;
  for (const PaperFigure& figure : paper_figures()) paper[figure.quantity] = figure;
  std::vector<std::string> columns = {"disturbance",     "torque_x_N_m",  "torque_y_N_m",
                                      "torque_z_N_m",    "torque_N_m",    "share_of_sum",
                                      "angle_1_min_deg", "angle_1_h_deg", "angle_1_day_deg"};
  if (budget.beside_paper) {
    columns.insert(columns.begin() + 1, "paper_figure");
    columns.insert(columns.end(), {"paper_N_m", "ratio"});
  }
  Table table = Table::of("budget", "Disturbance torques at the state, largest first", columns);
  double sum_N_m = 0.0;
  for (const BudgetEntry& e : budget.entries) sum_N_m += e.torque_body_N_m.norm();
  for (const BudgetEntry& e : budget.entries) {
    const double torque_N_m = e.torque_body_N_m.norm();
    const std::string figure = traits_of(e.kind).paper_figure;
    const double paper_N_m = figure.empty() ? std::nan("") : paper.at(figure).published;
    Table::Row row = table.row();
    row.set("disturbance", e.name)
        .set("torque_x_N_m", e.torque_body_N_m.x())
        .set("torque_y_N_m", e.torque_body_N_m.y())
        .set("torque_z_N_m", e.torque_body_N_m.z())
        .set("torque_N_m", torque_N_m)
        .set("share_of_sum", sum_N_m > 0.0 ? torque_N_m / sum_N_m : 0.0)
        .set("angle_1_min_deg", e.angle_after_minute_rad / degree_rad)
        .set("angle_1_h_deg", e.angle_after_hour_rad / degree_rad)
        .set("angle_1_day_deg", e.angle_after_day_rad / degree_rad);
    if (!budget.beside_paper) continue;
    row.set("paper_figure", figure.empty() ? "-" : figure)
        .set("paper_N_m", paper_N_m)
        .set("ratio", torque_N_m / paper_N_m);
  }
  return table;
}

Plot tilt_plot(const Budget& budget) {
  Plot plot{"torque_by_tilt", "Disturbance torques by tilt", "tilt [deg]", "torque [N m]"};
  plot.y_log = true;
  for (const std::string& name : names_of(budget.model.disturbances)) {
    plot.curves.push_back({name});
  }
  const double limit_rad = budget.model.platform.tilt_limit_rad.value_or(30.0 * degree_rad);
  const Vec3 rate_lab_rad_s = budget.state.lab_from_body * budget.state.rate_body_rad_s;
  const Dynamics dynamics(budget.model);
  constexpr int steps = 60;
  for (int i = 0; i <= steps; ++i) {
    const double tilt_rad = limit_rad * i / steps;
    const Quat attitude = lab_from_body_at(tilt_rad, heading_rad(budget.state)).rotation;
    // Appendages rotate with the body at every tilt.
    PlatformState state = dynamics.initial_state(attitude.conjugate() * rate_lab_rad_s);
    state.lab_from_body = attitude;
    state.time_s = budget.state.time_s;
    state.charge_drawn_C = budget.state.charge_drawn_C;
    const std::vector<Acting> acting = acting_within_a_second(budget.model, state);
    for (size_t d = 0; d < acting.size(); ++d) {
      if (!is_ranked(budget.model.disturbances[d])) continue;
      const double torque_N_m = acting[d].largest_body_N_m.norm();
      // A logarithmic axis has no zero.
      if (!(torque_N_m > 0.0) || !std::isfinite(torque_N_m)) continue;
      plot.curves[d].x.push_back(tilt_rad / degree_rad);
      plot.curves[d].y.push_back(torque_N_m);
    }
  }
  std::erase_if(plot.curves, [](const Plot::Curve& curve) { return curve.x.empty(); });
  return plot;
}

}  // namespace

Budget make_budget(AttitudeModel model, const PlatformState& state) {
  Budget budget{std::move(model), state, {}, {}, {}, true, {}};
  const std::vector<Acting> acting = acting_within_a_second(budget.model, state);
  const std::vector<std::string> names = names_of(budget.model.disturbances);
  const Mat3 inverse_inertia = budget.model.platform.inertia_kg_m2.inverse();
  for (size_t d = 0; d < acting.size(); ++d) {
    const Disturbance& disturbance = budget.model.disturbances[d];
    if (!is_ranked(disturbance)) continue;
    if (!acting[d].largest_body_N_m.allFinite() || !acting[d].mean_body_N_m.allFinite()) {
      throw NumericalError("budget: the torque of " + names[d] +
                           " is no finite number at this state");
    }
    const double acceleration_rad_s2 = (inverse_inertia * acting[d].mean_body_N_m).norm();
    const auto angle_after = [&](double t_s) { return 0.5 * acceleration_rad_s2 * t_s * t_s; };
    budget.entries.push_back({budget.model.disturbances[d].kind, names[d],
                              acting[d].largest_body_N_m, angle_after(minute_s),
                              angle_after(hour_s), angle_after(day_s)});
  }
  std::stable_sort(budget.entries.begin(), budget.entries.end(),
                   [](const BudgetEntry& a, const BudgetEntry& b) {
                     return a.torque_body_N_m.norm() > b.torque_body_N_m.norm();
                   });
  return budget;
}

Budget read_budget(const Settings& root) {
  AttitudeModel model = read_attitude_model(root).model;
  const Settings settings = own_table(root, "budget", false);
  const PlatformState state = read_state(settings, model);
  Budget budget = make_budget(std::move(model), state);
  budget.catalogue = read_catalogue(settings);
  budget.light = read_light(settings);
  budget.beside_paper = settings.has(budget_key::light) || settings.has(budget_key::bearing);
  budget.air_parts = read_own_air_parts(root);
  settings.finish();
  return budget;
}

Product budget_product(const Budget& budget) {
  PaperInputs inputs;
  inputs.light = budget.light;
  Product product = budget.beside_paper ? paper_product(inputs) : Product();
  product.tables.insert(product.tables.begin(), budget_table(budget));
  if (!budget.air_parts.empty()) {
    const Environment& room = budget.model.environment;
    product.tables.push_back(air_table(budget.air_parts,
                                       {room.air_density_kg_m3, room.air_viscosity_Pa_s},
                                       budget.state.rate_body_rad_s.norm()));
  }
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

Key budget_table() {
  using namespace budget_key;
  return budget.of({tilt, heading, spin, rate, state_of_charge, charge_drawn, time,
                    bearing.of({name, radius, half_angle, gap, inlet, load, drag, drag_rate}),
                    light.of({source_to_cell, conversion, power, power_at_30, torque_at_30})});
}

}  // namespace photorque
