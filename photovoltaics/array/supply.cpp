#include "photovoltaics/array/supply.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

// Curves are computed at multiples of this temperature step and interpolated linearly, with an
// error of 3e-5 of the power.
constexpr double temperature_step_K = 5.0;

// Fraction of the capacity by which the charge must move away from a limit before an event reports
// it: a load near the power of the array fills the battery in every other step.
constexpr double event_hysteresis = 0.01;

// State of a first-order lag towards 1 (on) or 0 (off) after `elapsed_s`.
double lagged(double from, bool on, double elapsed_s, double time_constant_s) {
  const double target = on ? 1.0 : 0.0;
  return target + (from - target) * std::exp(-elapsed_s / time_constant_s);
}

}  // namespace

LampOutput::LampOutput(const LampDroop& droop, const LampSchedule& schedule, double start_s)
    : droop_(droop) {
  Stage stage{start_s, schedule.on_at_start, 0.0, 0.0};
  for (const double time_s : schedule.time_s) {
    if (time_s <= start_s) {
      stage.on = !stage.on;
      continue;
    }
    stages_.push_back(stage);
    const double elapsed_s = time_s - stage.from_s;
    stage.faded = lagged(stage.faded, stage.on, elapsed_s, droop_.time_constant_s);
    stage.warm = lagged(stage.warm, stage.on, elapsed_s, droop_.rise_time_constant_s);
    stage.from_s = time_s;
    stage.on = !stage.on;
    switches_s_.push_back(time_s);
  }
  stages_.push_back(stage);
}

double LampOutput::at(double time_s) const {
  const auto after = std::ranges::upper_bound(stages_, time_s, {}, &Stage::from_s);
  const Stage& stage = after == stages_.begin() ? stages_.front() : *(after - 1);
  if (!stage.on) return 0.0;
  const double elapsed_s = std::max(0.0, time_s - stage.from_s);
  return droop_.light(lagged(stage.faded, true, elapsed_s, droop_.time_constant_s),
                      lagged(stage.warm, true, elapsed_s, droop_.rise_time_constant_s));
}

// The array at one temperature, or between two.
struct PowerSupply::Curves {
  struct Weighted {
    ArrayCurve curve;
    double weight;
  };
  std::vector<Weighted> curves;

  // Above the open-circuit voltage, the diode of the converter blocks.
  double current_A(double voltage_V) const {
    double sum = 0.0;
    for (const auto& [curve, weight] : curves) {
      if (voltage_V < curve.open_circuit_V()) sum += weight * curve.current_A(voltage_V);
    }
    return sum;
  }
  ArrayPoint best() const {
    double power_W = 0.0, voltage_V = 0.0;
    for (const auto& [curve, weight] : curves) {
      const ArrayPoint point = curve.maximum_power();
      power_W += weight * point.power_W();
      voltage_V += weight * point.voltage_V;
    }
    return {voltage_V, voltage_V > 0.0 ? power_W / voltage_V : 0.0};
  }
};

PowerSupply::PowerSupply(SupplyDesign design, double stored_J)
    : design_(std::move(design)),
      start_J_(stored_J),
      stored_J_(stored_J),
      start_K_(design_.array.heat ? design_.array.heat->start_K : design_.array.temperature_K),
      temperature_K_(start_K_) {
  for (const double area_m2 : design_.cell_area_m2) area_m2_ += area_m2;
  if (design_.array.heat) plate_.emplace(*design_.array.heat, area_m2_);
  full_.is_reached = design_.battery && stored_J_ >= design_.battery->capacity_J;
  empty_.is_reached = design_.battery && stored_J_ <= 0.0;
  if (design_.tracker && design_.max_photocurrent_A > 0.0) {
    const std::vector<double> brightest(design_.cell_area_m2.size(), design_.max_photocurrent_A);
    const CellTables tables =
        cell_tables(design_.array, design_.cell_area_m2, design_.max_photocurrent_A);
    control_.emplace(*design_.tracker,
                     ArrayCurve(design_.array.wiring, tables, brightest).open_circuit_V());
  }
}

// Temperature `index` · step, or index −1: that of the design.
const CellTables& PowerSupply::tables_at(int index) {
  const auto known = tables_.find(index);
  if (known != tables_.end()) return known->second;
  ArrayDesign warm = design_.array;
  if (index >= 0) warm.temperature_K = temperature_step_K * index;
  const std::vector<double> largest_A =
      warmed(warm, std::vector(design_.cell_area_m2.size(), design_.max_photocurrent_A),
             design_.array.temperature_K, warm.temperature_K);
  return tables_
      .emplace(index, cell_tables(warm, design_.cell_area_m2, std::ranges::max(largest_A)))
      .first->second;
}

void PowerSupply::step(double time_s, double step_s, const Light& light, bool judge) {
  state_ = {};
  state_.light_W = light.on_cells_W;
  double potential_W = 0.0;
  if (std::ranges::any_of(light.photocurrent_A, [](double i_A) { return i_A > 0.0; })) {
    Curves curves;
    const auto add = [&](int index, double weight) {
      if (weight == 0.0) return;
      const double kelvin = temperature_step_K * index;
      const std::vector<double> current_A = index < 0 ? light.photocurrent_A
                                                      : warmed(design_.array, light.photocurrent_A,
                                                               design_.array.temperature_K, kelvin);
      curves.curves.push_back({{design_.array.wiring, tables_at(index), current_A}, weight});
    };
    if (plate_) {
      const double steps =
          std::clamp(temperature_K_, coldest_cell_K, hottest_cell_K) / temperature_step_K;
      const int below = static_cast<int>(std::floor(steps));
      const double fraction = steps - below;
      add(below, 1.0 - fraction);
      add(below + 1, fraction);
    } else {
      add(-1, 1.0);
    }
    if (!control_ || judge) {
      const ArrayPoint best = curves.best();
      state_.best_W = best.power_W();
      state_.voltage_V = best.voltage_V;
    }
    if (control_) {
      state_.voltage_V = control_->voltage_V();
      const double current_A = curves.current_A(state_.voltage_V);
      potential_W = state_.voltage_V * current_A;
      control_->observe({state_.voltage_V, current_A});
      if (judge && light.on_cells_W > 0.0) best_per_light_ = state_.best_W / light.on_cells_W;
      if (!judge) state_.best_W = std::max(potential_W, best_per_light_ * light.on_cells_W);
    } else {
      potential_W = state_.best_W;
    }
  } else if (control_) {
    control_->observe({control_->voltage_V(), 0.0});
  }
  energies_.on_cells.add(light.on_cells_W * step_s);
  energies_.best.add(state_.best_W * step_s);
  take(time_s, step_s, potential_W);
  warm(step_s);
}

// Distributes the array's power to converter, load and battery.
void PowerSupply::take(double time_s, double step_s, double potential_W) {
  const double efficiency = design_.converter_efficiency;
  if (!design_.battery) {
    state_.array_W = potential_W;
    state_.load_W = efficiency * potential_W;
    energies_.array.add(potential_W * step_s);
    energies_.load.add(efficiency * potential_W * step_s);
    energies_.converter.add((1.0 - efficiency) * potential_W * step_s);
    return;
  }
  const Battery& battery = *design_.battery;
  const double surplus_W = efficiency * potential_W - design_.load_W;
  // The first part of the step ends when the battery is full or empty. In the rest, the array
  // supplies what the load needs, or the load receives what the array supplies.
  const double before_J = stored_J_;
  const Battery::Step step = battery.step(stored_J_, surplus_W, step_s);
  stored_J_ = step.charge_J;
  const double first_s = step.until_limit_s, rest_s = step_s - first_s;
  double array_J = potential_W * step_s, load_J = design_.load_W * step_s;
  double into_J = 0.0, out_J = 0.0;
  if (surplus_W >= 0.0) {
    into_J = surplus_W * first_s;
    array_J = potential_W * first_s + design_.load_W / efficiency * rest_s;
  } else {
    out_J = -surplus_W * first_s;
    load_J = design_.load_W * first_s + efficiency * potential_W * rest_s;
  }
  add_event(full_, battery.capacity_J - before_J, battery.capacity_J - stored_J_, time_s, first_s);
  add_event(empty_, before_J, stored_J_, time_s, first_s);
  energies_.array.add(array_J);
  energies_.converter.add((1.0 - efficiency) * array_J);
  energies_.load.add(load_J);
  energies_.unserved.add(design_.load_W * step_s - load_J);
  energies_.into_battery.add(into_J);
  energies_.out_of_battery.add(out_J);
  energies_.battery_loss.add(into_J * (1.0 - battery.charge_efficiency) +
                             out_J * (1.0 / battery.discharge_efficiency - 1.0));
  state_.array_W = array_J / step_s;
  state_.load_W = load_J / step_s;
  state_.battery_W = (stored_J_ - before_J) / step_s;
}

// Adds an event if the battery reaches a limit or leaves it. The distances from the limit are those
// before and after a step.
void PowerSupply::add_event(ChargeLimit& limit, double before_J, double after_J, double time_s,
                            double until_limit_s) {
  if (before_J <= 0.0) limit.last_s = time_s;
  if (!limit.is_reached && after_J <= 0.0) {
    limit.is_reached = true;
    events_.push_back({limit.reached, time_s + until_limit_s});
  } else if (limit.is_reached && after_J > event_hysteresis * design_.battery->capacity_J) {
    limit.is_reached = false;
    events_.push_back({limit.left, limit.last_s});
  }
}

void PowerSupply::warm(double step_s) {
  if (!plate_) return;
  const double absorptance = design_.array.heat->absorptance;
  energies_.reflected.add((1.0 - absorptance) * state_.light_W * step_s);
  const double heating_W = absorptance * state_.light_W - state_.array_W;
  const CellPlate::Step step = plate_->step(temperature_K_, heating_W / area_m2_, step_s);
  energies_.given_off.add(step.given_off_J_m2 * area_m2_);
  temperature_K_ = step.end_K;
}

SupplyClosure PowerSupply::closure() const {
  const SupplyEnergies& e = energies_;
  SupplyClosure closure;
  const auto relative = [](double rest, double whole) {
    return whole > 0.0 ? std::abs(rest) / whole : 0.0;
  };
  if (plate_) {
    const double stored_J =
        design_.array.heat->capacity_J_m2_K * area_m2_ * (temperature_K_ - start_K_);
    closure.cells = relative(
        e.on_cells.value() - e.reflected.value() - e.array.value() - e.given_off.value() - stored_J,
        e.on_cells.value());
  }
  closure.bus = relative(e.array.value() + e.out_of_battery.value() - e.converter.value() -
                             e.load.value() - e.into_battery.value(),
                         e.array.value() + e.out_of_battery.value());
  closure.battery =
      relative(e.into_battery.value() - e.out_of_battery.value() - e.battery_loss.value() -
                   (stored_J_ - start_J_),
               std::max(e.into_battery.value() + e.out_of_battery.value(), std::abs(start_J_)));
  return closure;
}

void PowerSupply::keep(Snapshot& snapshot) {
  snapshot(stored_J_, temperature_K_, best_per_light_, state_, energies_);
  for (ChargeLimit* limit : {&full_, &empty_}) snapshot(limit->is_reached, limit->last_s);
  if (control_) snapshot(*control_);
  snapshot.each(events_, [&](SupplyEvent& event) { snapshot(event.name, event.time_s); });
}

}  // namespace photorque
