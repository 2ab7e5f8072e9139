#include "photovoltaics/array/day.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/settings/typed_keys.h"

namespace photorque {
namespace {

namespace day_key {
constexpr double year_s = 366.0 * 86400.0;
constexpr DaySettings usual;
constexpr Range efficiency{0.0, 1.0, true, false};
constexpr NumberKey load("load_W", usual.load_W, Range::not_negative(), "constant load");
constexpr NumberKey duration("duration_s", usual.duration_s, {0.0, year_s, true, false},
                             "simulated time, in steps of at most 30 s");
constexpr FlagKey lamps_on("lamps_on", true, "false: only the battery supplies the load");
constexpr NumberKey battery("battery_Wh", usual.battery.capacity_J, Range::positive(),
                            "capacity of the battery");
constexpr NumberKey battery_charge("battery_charge", usual.battery.charge, Range::fraction(),
                                   "state of charge at the start");
constexpr NumberKey charge_efficiency(
    "charge_efficiency", usual.battery.charge_efficiency, efficiency,
    "stored energy divided by the energy delivered to the battery");
constexpr NumberKey discharge_efficiency(
    "discharge_efficiency", usual.battery.discharge_efficiency, efficiency,
    "energy delivered by the battery divided by the stored energy used");
constexpr NumberKey converter_efficiency(
    "converter_efficiency", usual.converter_efficiency, efficiency,
    "efficiency of the converter between array and battery; independent of `[array.chain]`");
constexpr NumberKey droop_depth("droop_depth", usual.droop.depth, {0.0, 1.0, false, true},
                                "fraction of their light that lamps lose when warm");
constexpr NumberKey droop_time("droop_time_s", usual.droop.time_constant_s, Range::positive(),
                               "time constant of the loss");
constexpr NumberKey roll_off(
    "roll_off_per_K", usual.droop.roll_off_1_K, {0.0, 0.1},
    "fraction of their light that lamps lose per kelvin of their junctions (red LEDs about 5e-3)");
constexpr NumberKey lamp_rise("lamp_rise_K", usual.droop.rise_K, {0.0, 300.0},
                              "temperature rise of the junctions");
constexpr NumberKey lamp_rise_time("lamp_rise_time_s", usual.droop.rise_time_constant_s,
                                   Range::positive(), "time constant of the rise");
}  // namespace day_key

// Power over temperature and light, on a small grid.
class PowerSurface {
 public:
  PowerSurface(const ArrayDesign& design, const ArrayResult& array, double low_K, double high_K,
               double min_light)
      : low_K_(low_K), high_K_(high_K), min_light_(min_light) {
    for (size_t t = 0; t < temperatures; ++t) {
      ArrayDesign warm = design;
      warm.temperature_K = std::lerp(low_K, high_K, static_cast<double>(t) / (temperatures - 1));
      for (size_t l = 0; l < lights; ++l) {
        const double light = std::lerp(min_light, 1.0, static_cast<double>(l) / (lights - 1));
        power_W_[t][l] = array_power_W(warm, array, design.temperature_K, light);
      }
    }
  }

  double at(double temperature_K, double light) const {
    const auto [t, tf] = place(temperature_K, low_K_, high_K_, temperatures);
    const auto [l, lf] = place(light, min_light_, 1.0, lights);
    return std::lerp(std::lerp(power_W_[t][l], power_W_[t][l + 1], lf),
                     std::lerp(power_W_[t + 1][l], power_W_[t + 1][l + 1], lf), tf);
  }

 private:
  static constexpr size_t temperatures = 7, lights = 5;
  struct Place {
    size_t index;
    double fraction;
  };
  static Place place(double x, double low, double high, size_t count) {
    const double s =
        high > low ? std::clamp((x - low) / (high - low), 0.0, 1.0) * static_cast<double>(count - 1)
                   : 0.0;
    const auto i = std::min(static_cast<size_t>(s), count - 2);
    return {i, s - static_cast<double>(i)};
  }

  double low_K_, high_K_, min_light_;
  std::array<std::array<double, lights>, temperatures> power_W_{};
};

}  // namespace

Battery::Step Battery::step(double charge_J, double surplus_W, double step_s) const {
  const bool charges = surplus_W >= 0.0;
  const double rate_W = charges ? surplus_W * charge_efficiency : surplus_W / discharge_efficiency;
  const double room_J = charges ? capacity_J - charge_J : -charge_J;
  const bool reaches_limit = rate_W != 0.0 && rate_W * step_s / room_J >= 1.0;
  if (reaches_limit) return {charges ? capacity_J : 0.0, room_J / rate_W};
  return {std::clamp(charge_J + rate_W * step_s, 0.0, capacity_J), step_s};
}

double LampDroop::light_at(double time_s) const {
  return light(-std::expm1(-time_s / time_constant_s), -std::expm1(-time_s / rise_time_constant_s));
}

DayResult run_day(const ArrayDesign& design, const ArrayResult& array, const DaySettings& s) {
  const double light_W_m2 =
      s.lamps_on ? array.power_on_cells_W.value / array.area_of_cells_m2 : 0.0;
  const auto computed_K = [](double kelvin) {
    return std::clamp(kelvin, coldest_cell_K, hottest_cell_K);
  };
  std::optional<CellPlate> plate;
  double temperature_K = design.temperature_K, low_K = temperature_K, high_K = temperature_K;
  if (design.heat) {
    plate.emplace(*design.heat, array.area_of_cells_m2);
    temperature_K = design.heat->start_K;
    // The temperature is between the initial one and the steady states in least and most light.
    const double absorptance = design.heat->absorptance;
    const double least =
        s.droop.min_light() * std::max(0.0, absorptance - 1.5 * array.efficiency.value);
    const double coldest_K = plate->temperature_at_loss_K(least * light_W_m2);
    const double hottest_K = plate->temperature_at_loss_K(absorptance * light_W_m2);
    low_K = computed_K(std::min(temperature_K, coldest_K));
    high_K = computed_K(std::max(temperature_K, hottest_K));
  }
  const PowerSurface surface(design, array, low_K, high_K, s.droop.min_light());
  DayResult day;
  double charge_J = s.battery.capacity_J * s.battery.charge;
  const auto steps = static_cast<int64_t>(std::ceil(s.duration_s / s.step_s));
  const double step_s = s.duration_s / static_cast<double>(steps);
  for (int64_t k = 0; k <= steps; ++k) {
    const double time_s = static_cast<double>(k) * step_s;
    const double light = s.droop.light_at(time_s);
    const double array_W =
        s.lamps_on ? s.tracker_efficiency * surface.at(temperature_K, light) : 0.0;
    day.time_s.push_back(time_s);
    day.temperature_K.push_back(temperature_K);
    day.array_W.push_back(array_W);
    day.charge_J.push_back(charge_J);
    if (k == steps) break;
    const double surplus_W = array_W * s.converter_efficiency - s.load_W;
    const Battery::Step step = s.battery.step(charge_J, surplus_W, step_s);
    charge_J = step.charge_J;
    const bool is_unserved = surplus_W < 0.0 && step.until_limit_s < step_s;
    if (is_unserved && !day.empty_after_s) day.empty_after_s = time_s;
    day.array_energy_J += array_W * step_s;
    if (plate) {
      const double heating_W_m2 =
          design.heat->absorptance * light * light_W_m2 - array_W / array.area_of_cells_m2;
      temperature_K = plate->step(temperature_K, heating_W_m2, step_s).end_K;
    }
  }
  day.mean_array_W = day.array_energy_J / s.duration_s;
  return day;
}

DaySettings read_day(const Settings& s) {
  DaySettings day;
  day.load_W = s.get(day_key::load);
  day.duration_s = s.get(day_key::duration);
  day.lamps_on = s.get(day_key::lamps_on);
  day.converter_efficiency = s.get(day_key::converter_efficiency);
  day.battery.capacity_J = s.get(day_key::battery);
  day.battery.charge = s.get(day_key::battery_charge);
  day.battery.charge_efficiency = s.get(day_key::charge_efficiency);
  day.battery.discharge_efficiency = s.get(day_key::discharge_efficiency);
  day.droop.depth = s.get(day_key::droop_depth);
  day.droop.time_constant_s = s.get(day_key::droop_time);
  day.droop.roll_off_1_K = s.get(day_key::roll_off);
  day.droop.rise_K = s.get(day_key::lamp_rise);
  day.droop.rise_time_constant_s = s.get(day_key::lamp_rise_time);
  if (!(day.droop.roll_off_1_K * day.droop.rise_K < 1.0)) {
    throw s.error(day_key::roll_off, "a roll-off that leaves no light at lamp_rise_K",
                  "roll_off_per_K * lamp_rise_K < 1");
  }
  return day;
}

Product day_product(const DayResult& day) {
  Product product;
  product.quantities = {{"day_end_cell_temperature_K", {day.temperature_K.back(), 0.0}},
                        {"mean_array_power_W", {day.mean_array_W, 0.0}},
                        {"battery_left_J", {day.charge_J.back(), 0.0}}};
  std::vector<double> hours, charge_Wh;
  for (const double t : day.time_s) hours.push_back(t / 3600.0);
  for (const double q : day.charge_J) charge_Wh.push_back(q / 3600.0);
  product.tables.push_back({"day",
                            "Array and battery over time",
                            {{"time_s", day.time_s, {}},
                             {"cell_temperature_K", day.temperature_K, {}},
                             {"array_power_W", day.array_W, {}},
                             {"battery_charge_J", day.charge_J, {}}}});
  Plot plot{"day_history", "Array and battery over time", "time [h]", "array [W]"};
  plot.curves.push_back({"array power", hours, day.array_W});
  plot.below.push_back({"cells [K]", {{"cell temperature", hours, day.temperature_K}}});
  plot.below.push_back({"battery [Wh]", {{"charge", hours, charge_Wh}}});
  product.plots.push_back(plot);
  return product;
}

std::vector<Key> day_keys() {
  using namespace day_key;
  return {load,
          duration,
          lamps_on,
          battery,
          battery_charge,
          charge_efficiency,
          discharge_efficiency,
          converter_efficiency,
          droop_depth,
          droop_time,
          roll_off,
          lamp_rise,
          lamp_rise_time};
}

}  // namespace photorque
