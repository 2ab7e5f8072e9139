#include "tools/supply/trade.h"

#include <algorithm>
#include <cmath>

#include "attitude/disturbances/kind.h"
#include "attitude/propagation/run.h"
#include "core/constants.h"
#include "core/transform.h"

namespace photorque {

namespace {

namespace supply_key {
constexpr NumberKey load("load_W", 25.0, Range::positive(), "power delivered to the load");
constexpr NumberKey duration("duration_h", 86400.0, Range::positive(), "duration of the task");
constexpr NumberKey tilt_max("tilt_max_deg", {0.0, 80.0 * degree_rad, true, false},
                             "largest tilt of the comparison",
                             {.usually = "the platform's stop, else 30"});
constexpr IntegerKey tilts("tilts", 7, 2, 181, "number of tilts from zero to `tilt_max_deg`");
constexpr TableKey supply("supply_trade",
                          "comparison of power supplies; battery, cable and induction are always "
                          "included, with defaults if they have no table");
}  // namespace supply_key

}  // namespace

SupplyTask read_supply_task(const Settings& root, const Settings& s) {
  SupplyTask task;
  task.model = read_attitude_model(root).model;
  task.model.disturbances.clear();
  task.load_W = s.get(supply_key::load);
  task.duration_s = s.get(supply_key::duration);
  const double usual_rad = task.model.platform.tilt_limit_rad.value_or(30.0 * degree_rad);
  const double most_rad = s.get_or(supply_key::tilt_max, usual_rad);
  const int64_t tilts = s.get(supply_key::tilts);
  for (int64_t i = 0; i < tilts; ++i) {
    task.tilt_rad.push_back(most_rad * static_cast<double>(i) / static_cast<double>(tilts - 1));
  }
  return task;
}

size_t UncertainInputs::add(const Settings& settings, const UncertainNumberKey& key) {
  inputs_.push_back(settings.get(key));
  return inputs_.size() - 1;
}

std::vector<Estimate> UncertainInputs::evaluate(
    const std::function<std::vector<double>(const std::vector<double>&)>& f) const {
  std::vector<double> at;
  for (const Uncertain& input : inputs_) at.push_back(input.value);
  std::vector<Estimate> results;
  for (const double value : f(at)) results.push_back({value, 0.0});
  for (size_t i = 0; i < inputs_.size(); ++i) {
    if (inputs_[i].sigma == 0.0) continue;
    std::vector<double> above = at, below = at;
    above[i] += inputs_[i].sigma;
    below[i] -= inputs_[i].sigma;
    const std::vector<double> high = f(above), low = f(below);
    for (size_t k = 0; k < results.size(); ++k) {
      const double half = 0.5 * (high[k] - low[k]);
      results[k].standard_error = std::hypot(results[k].standard_error, half);
    }
  }
  return results;
}

SupplyOption option_from(const UncertainInputs& inputs, const SupplyTask& task,
                         const std::function<PlainOption(const std::vector<double>&)>& f,
                         const std::vector<std::string>& figure_names) {
  const size_t tilts = task.tilt_rad.size();
  const std::vector<Estimate> all = inputs.evaluate([&](const std::vector<double>& at) {
    const PlainOption plain = f(at);
    std::vector<double> row = {plain.mass_kg, plain.source_W};
    for (const auto* column : {&plain.delivered_W, &plain.torque_N_m, &plain.alternating_N_m}) {
      for (size_t t = 0; t < tilts; ++t) row.push_back(column->empty() ? 0.0 : (*column)[t]);
    }
    row.insert(row.end(), plain.figures.begin(), plain.figures.end());
    return row;
  });
  SupplyOption option;
  option.mass_kg = all[0];
  option.source_W = all[1];
  for (size_t t = 0; t < tilts; ++t) {
    option.curve.push_back({all[2 + t], all[2 + tilts + t], all[2 + 2 * tilts + t]});
  }
  for (size_t i = 0; i < figure_names.size(); ++i) {
    option.figures.emplace_back(figure_names[i], all[2 + 3 * tilts + i]);
  }
  return option;
}

double disturbance_torque_N_m(const SupplyTask& task, const std::string& kind,
                              const std::vector<std::pair<std::string, std::vector<double>>>& keys,
                              double tilt_rad, double charge_drawn_C) {
  AttitudeModel model = task.model;
  model.disturbances = {
      make_disturbance_of(kind, keys, DisturbanceContext{model.platform, model.environment})};
  PlatformState state = Dynamics(model).initial_state();
  state.lab_from_body = lab_from_body_at(tilt_rad, 0.0).rotation;
  state.charge_drawn_C = charge_drawn_C;
  return disturbance_torques_body_N_m(model, state).front().y();
}

namespace {

// Magnitude of a torque; a torque with zero mean counts with its error.
double size_of(const Estimate& x) {
  return std::max(std::abs(x.value), x.standard_error);
}

}  // namespace

SupplyDisturbance disturbance_of(const SupplyOption& option, const SupplyTask& task) {
  SupplyDisturbance worst;
  const double angle_rad_N_m = 0.5 * task.duration_s * task.duration_s / task.level_moment_kg_m2();
  for (const SupplyPoint& point : option.curve) {
    worst.alternating_N_m = std::max(worst.alternating_N_m, point.alternating_N_m.value);
    if (size_of(point.torque_N_m) > size_of(worst.torque_N_m)) worst.torque_N_m = point.torque_N_m;
    if (!(point.delivered_W.value > 0.0)) continue;
    const Estimate per_W{std::abs(point.torque_N_m.value) / point.delivered_W.value,
                         point.torque_N_m.standard_error / point.delivered_W.value};
    if (size_of(per_W) > size_of(worst.torque_N_m_W)) worst.torque_N_m_W = per_W;
  }
  worst.angle_rad_W = {angle_rad_N_m * worst.torque_N_m_W.value,
                       angle_rad_N_m * worst.torque_N_m_W.standard_error};
  return worst;
}

Key supply_table() {
  using namespace supply_key;
  return supply.of({load, duration, tilt_max, tilts, battery_table(), cable_table(),
                    microwave_table(), induction_table(), beam_table()});
}

}  // namespace photorque
