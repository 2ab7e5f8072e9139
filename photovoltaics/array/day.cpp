#include "photovoltaics/array/day.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace photorque {
namespace {

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

// One step of the battery; returns what of the load was served.
double step_battery(const Battery& battery, double surplus_W, double step_s, double* charge_J) {
  if (surplus_W >= 0.0) {
    *charge_J =
        std::min(battery.capacity_J, *charge_J + surplus_W * battery.charge_efficiency * step_s);
    return 1.0;
  }
  const double needed_J = -surplus_W / battery.discharge_efficiency * step_s;
  const double given_J = std::min(needed_J, *charge_J);
  *charge_J -= given_J;
  return given_J / needed_J;
}

}  // namespace

double LampDroop::light_at(double time_s) const {
  const double faded = depth * -std::expm1(-time_s / time_constant_s);
  const double warmth_K = rise_K * -std::expm1(-time_s / rise_time_constant_s);
  return (1.0 - faded) * (1.0 - roll_off_1_K * warmth_K);
}

DayResult run_day(const ArrayDesign& design, const ArrayResult& array, const DaySettings& s) {
  const double light_W_m2 =
      s.lamps_on ? array.power_on_cells_W.value / array.area_of_cells_m2 : 0.0;
  double temperature_K = s.heat ? s.heat->air_K : design.temperature_K;
  const double hottest_K =
      s.heat ? temperature_K + s.heat->absorptance * light_W_m2 / s.heat->convection_W_m2_K
             : temperature_K;
  const PowerSurface surface(design, array, temperature_K, hottest_K, s.droop.min_light());
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
    const double served =
        step_battery(s.battery, array_W * s.converter_efficiency - s.load_W, step_s, &charge_J);
    if (served < 1.0 && !day.empty_after_s) day.empty_after_s = time_s;
    day.array_energy_J += array_W * step_s;
    day.load_energy_J += s.load_W * step_s;
    if (s.heat) {
      // Exact for constant power over the step, so that any step is stable.
      const double heat_W_m2 =
          s.heat->absorptance * light * light_W_m2 - array_W / array.area_of_cells_m2;
      const double end_K = s.heat->air_K + heat_W_m2 / s.heat->convection_W_m2_K;
      temperature_K =
          end_K + (temperature_K - end_K) *
                      std::exp(-step_s * s.heat->convection_W_m2_K / s.heat->capacity_J_m2_K);
    }
  }
  day.final_temperature_K = temperature_K;
  day.mean_array_W = day.array_energy_J / s.duration_s;
  return day;
}

DaySettings read_day(const Settings& s) {
  DaySettings day;
  day.load_W = s.number_or("load_W", day.load_W, Range::not_negative());
  constexpr double year_s = 366.0 * 86400.0;
  day.duration_s = s.number_or("duration_s", day.duration_s, {0.0, year_s, true, false});
  day.lamps_on = s.flag_or("lamps_on", true);
  day.converter_efficiency =
      s.number_or("converter_efficiency", day.converter_efficiency, {0.0, 1.0, true, false});
  day.battery.capacity_J = s.number_or("battery_J", 360.0 * 3600.0, Range::positive());
  day.battery.charge = s.number_or("battery_charge", 1.0, Range::fraction());
  day.battery.charge_efficiency =
      s.number_or("charge_efficiency", day.battery.charge_efficiency, {0.0, 1.0, true, false});
  day.battery.discharge_efficiency = s.number_or(
      "discharge_efficiency", day.battery.discharge_efficiency, {0.0, 1.0, true, false});
  day.droop.depth = s.number_or("droop_depth", 0.0, {0.0, 1.0, false, true});
  day.droop.time_constant_s =
      s.number_or("droop_time_s", day.droop.time_constant_s, Range::positive());
  day.droop.roll_off_1_K = s.number_or("roll_off_per_K", 0.0, {0.0, 0.1});
  day.droop.rise_K = s.number_or("lamp_rise_K", 0.0, {0.0, 300.0});
  day.droop.rise_time_constant_s =
      s.number_or("lamp_rise_time_s", day.droop.rise_time_constant_s, Range::positive());
  if (!(day.droop.roll_off_1_K * day.droop.rise_K < 1.0)) {
    throw s.error("roll_off_per_K", "a roll-off that leaves no light at lamp_rise_K",
                  "roll_off_per_K * lamp_rise_K < 1");
  }
  if (s.flag_or("heat", true)) {
    CellHeat heat;
    heat.air_K = s.number_or("air_K", heat.air_K, Range::positive());
    heat.convection_W_m2_K =
        s.number_or("convection_W_m2_K", heat.convection_W_m2_K, Range::positive());
    heat.absorptance = s.number_or("absorptance", heat.absorptance, Range::fraction());
    heat.capacity_J_m2_K = s.number_or("capacity_J_m2_K", heat.capacity_J_m2_K, Range::positive());
    day.heat = heat;
  }
  return day;
}

Product day_product(const DayResult& day) {
  Product product;
  product.quantities = {{"cell_temperature_K", {day.final_temperature_K, 0.0}},
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
  Plot plot{
      "day_history", "Array and battery over time", "time [h]", "array [W]", {}, false, false, {}};
  plot.curves.push_back({"array power", hours, day.array_W, {}, false});
  plot.below.push_back(
      {"cells [K]", {{"cell temperature", hours, day.temperature_K, {}, false}}, false});
  plot.below.push_back({"battery [Wh]", {{"charge", hours, charge_Wh, {}, false}}, false});
  product.plots.push_back(plot);
  return product;
}

}  // namespace photorque
